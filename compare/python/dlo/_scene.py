"""Scenes: from files, from text, or built in code."""

from __future__ import annotations

import copy
import math
import os
from typing import Any, Callable, Iterable, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _dlo
from ._arguments import LIST, TABLE, TEXT, require
from ._errors import InputError

Quantity = Union[float, str]
"""A number in SI units, or text with a unit: 0.006 or "6 mm"."""

Vector = Union[Sequence[Quantity], NDArray[Any]]
"""Three of these, or a NumPy array of shape (3,)."""

Direction = Union[Quantity, Vector]
"""An angle in the x-y plane from +x ("30 deg", or a number in rad), or a vector of any length."""

SceneLike = Union["Scene", str, "os.PathLike[str]"]
"""A scene, or the name of a scene file."""


def _copied(key: str, value: Any) -> Any:
    """A value that is the scene's own."""
    try:
        return copy.deepcopy(value)
    except RecursionError:
        raise InputError(f"scene: {key}: nested too deep (allowed: 32 levels)", key) from None
    except (TypeError, copy.Error):
        raise InputError(
            f"scene: {key}: a {type(value).__name__} (allowed: a number, text, a list, a table)", key
        ) from None


def _number(value: Any, dimension: str) -> Any:
    """What a document says in SI units; of a list each of its numbers, as an array."""
    if isinstance(value, str):
        return _dlo.quantity(value, dimension)
    if isinstance(value, (list, tuple, numpy.ndarray)):
        array = numpy.array([_number(one, dimension) for one in value], dtype=float)
        array.flags.writeable = False
        return array
    return None if value is None else float(value)


def _direction(value: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, (list, tuple, numpy.ndarray)):
        vector = _number(value, "number")
        unit = vector / numpy.linalg.norm(vector)
    else:
        angle = _number(value, "angle")
        unit = numpy.array([math.cos(angle), math.sin(angle), 0.0])
    unit.flags.writeable = False
    return unit


def _as_it_is(value: Any) -> Any:
    return copy.deepcopy(value)


def _field(key: str, read: Callable[[Any], Any], doc: str) -> property:
    """A key of an element: read in SI units, set as Part._set does."""

    def get(self: "Part") -> Any:
        return read(self._table.get(key))

    def put(self: "Part", value: Any) -> None:
        self._set(key, value)

    return property(get, put, doc=doc)


def _of(dimension: str) -> Callable[[Any], Any]:
    return lambda value: _number(value, dimension)


class Part:
    """An element of a scene: a table of its file.

    A part is read in SI units. Set, it takes numbers in SI units or text with a unit; a scene that
    holds it is read anew at once, so that a value out of range is an InputError that names the key,
    and the scene stays as it was. None takes a key out.
    """

    def __init__(self, **table: Any) -> None:
        self._owner: Optional[Scene] = None
        self._table: dict[str, Any] = {
            key: _copied(key, value) for key, value in table.items() if value is not None
        }

    def _set(self, key: str, value: Any) -> None:
        before = dict(self._table)
        if value is None:
            self._table.pop(key, None)
        else:
            self._table[key] = _copied(key, value)
        if self._owner is None:
            return
        try:
            self._owner._read_anew()
        except InputError:
            self._table.clear()
            self._table.update(before)
            raise

    def __repr__(self) -> str:
        inside = ", ".join(f"{key}={value!r}" for key, value in self._table.items())
        return f"dlo.{type(self).__name__}({inside})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and repr(self) == repr(other)

    __hash__ = None  # type: ignore[assignment]


class Gripper(Part):
    """What holds a point of the rod; clamp() and pin() make one."""

    at = _field("at", _of("length"), "Arc length that is held [m].")
    position = _field("position", _of("length"), "Where [m], shape (3,).")
    hold = _field("hold", lambda value: value or "clamp", '"clamp" or "pin".')
    direction = _field(
        "direction", _direction, "Of a clamp: unit vector along growing arc length, shape (3,)."
    )
    roll = _field("roll", _of("angle"), "Rotation about the direction that the clamp holds [rad].")
    frame = _field("frame", _of("number"), "Rows d1, d2, d3 that the clamp holds, shape (3, 3).")
    quaternion = _field("quaternion", _of("number"), "The same as [w, x, y, z], shape (4,).")
    turns = _field("turns", _as_it_is, "Whole turns more than the least, beside a frame.")


class Load(Part):
    """A force that keeps its direction, or a mass that hangs; load() makes one."""

    at = _field("at", _of("length"), "Arc length [m].")
    force = _field("force", _of("force"), "[N], shape (3,).")
    mass = _field("mass", _of("mass"), "[kg], instead of a force.")


class Obstacle(Part):
    """A body that the rod cannot pass; obstacle() makes one."""

    point = _field("point", _of("length"), "Of a plane, or the body's centre [m], shape (3,).")
    shape = _field(
        "shape", lambda value: value or "plane", '"plane", "sphere", "cylinder", "capsule", "box".'
    )
    normal = _field("normal", _direction, "Of a plane, to the free side; of a box an edge.")
    axis = _field("axis", _direction, "Of a cylinder, a capsule or a box.")
    radius = _field("radius", _of("length"), "[m]; of a box that of its edges.")
    length = _field("length", _of("length"), "Of a capsule, between its centres [m].")
    size = _field("size", _of("length"), "Of a box [m], shape (3,).")
    stiffness = _field("stiffness", _of("foundation"), "Force per depth and length [N/m^2].")
    friction = _field("friction", _of("number"), "Coulomb's coefficient [-]; no model has it.")
    touches = _field("touches", lambda value: value or "surface", '"surface" or "axis" of the rod.')


class Section(Part):
    """A part of the rod that is another one; section() makes one."""

    start = _field("from", _of("length"), "Where it begins [m] (`from` in a file).")
    end = _field("to", _of("length"), "Where it ends [m] (`to` in a file).")
    bending_stiffness = _field("bending_stiffness", _of("section_stiffness"), "EI [N m^2].")
    mass_per_length = _field("mass_per_length", _of("mass_per_length"), "rho A [kg/m].")
    torsional_stiffness = _field("torsional_stiffness", _of("section_stiffness"), "GJ [N m^2].")


class ForceModelSettings(Part):
    """How a scene is stepped: scene.force_model. What is not set is read as it is derived."""

    def _get(self, key: str) -> Any:
        if self._owner is not None:
            return self._owner._data.force_model[key]
        return self._table.get(key)

    def _setting(key: str, doc: str) -> property:  # type: ignore[misc]
        def get(self: "ForceModelSettings") -> Any:
            return self._get(key)

        def put(self: "ForceModelSettings", value: Any) -> None:
            self._set(key, value)

        return property(get, put, doc=doc)

    points = _setting("points", "N.")
    law = _setting("law", '"hooke" (linear) or "paper" (cubic).')
    bookkeeping = _setting("bookkeeping", '"consistent" or "paper".')
    stepper = _setting("stepper", '"auto", or one of the paper\'s.')
    bending_rule = _setting("bending_rule", "Of the law paper.")
    design_curvature = _setting("design_curvature", "k of Formula 21 [1/m]; None: derived.")
    point_weight = _setting("point_weight", "Of every point [N]; None: derived.")
    c_b = _setting("c_b", "[N]; None: derived.")
    c_c = _setting("c_c", "[N]; None: derived.")
    c_F = _setting("c_F", "[m/N]; None: derived.")
    c_h = _setting("c_h", "[-]; None: derived.")
    l_s = _setting("l_s", "[m]; None: derived.")
    del _setting


def _settings_of(table: Any) -> ForceModelSettings:
    require("force_model", table, TABLE)
    for key in table:
        require("force_model: a key", key, TEXT)
    return ForceModelSettings(**table)


def clamp(
    at: Quantity,
    position: Vector,
    direction: Optional[Direction] = None,
    *,
    roll: Optional[Quantity] = None,
    frame: Optional[ArrayLike] = None,
    quaternion: Optional[ArrayLike] = None,
    turns: Optional[int] = None,
) -> Gripper:
    """A gripper that holds position [m] and direction of the rod at an arc length [m].

    direction may be left out beside a frame or a quaternion, whose d3 it is. roll (an angle), frame
    (rows d1, d2, d3) or quaternion [w, x, y, z] also keep the rod from rotating about itself; turns
    are whole turns more than the least.
    """
    return Gripper(
        at=at,
        position=position,
        direction=direction,
        roll=roll,
        frame=frame,
        quaternion=quaternion,
        turns=turns,
    )


def pin(at: Quantity, position: Vector) -> Gripper:
    """A gripper that holds the position [m] of the rod at an arc length [m]."""
    return Gripper(at=at, position=position, hold="pin")


def load(
    at: Quantity, force: Optional[Vector] = None, *, mass: Optional[Quantity] = None
) -> Load:
    """A force [N], or a mass [kg] that hangs, at an arc length [m]."""
    return Load(at=at, force=force, mass=mass)


def obstacle(
    point: Vector,
    normal: Optional[Vector] = None,
    *,
    shape: Optional[str] = None,
    axis: Optional[Vector] = None,
    radius: Optional[Quantity] = None,
    length: Optional[Quantity] = None,
    size: Optional[Vector] = None,
    stiffness: Optional[Quantity] = None,
    friction: Optional[float] = None,
    touches: Optional[str] = None,
) -> Obstacle:
    """A plane (point [m], normal to the free side), or another shape with what it needs.

    shape: "sphere" (radius), "cylinder" (axis, radius), "capsule" (axis, length, radius) or "box"
    (size, axis, normal, radius of its edges). stiffness [N/m^2]: of one that yields.
    """
    return Obstacle(
        point=point,
        normal=normal,
        shape=shape,
        axis=axis,
        radius=radius,
        length=length,
        size=size,
        stiffness=stiffness,
        friction=friction,
        touches=touches,
    )


def section(
    start: Quantity,
    end: Quantity,
    *,
    bending_stiffness: Optional[Union[Quantity, Sequence[Quantity]]] = None,
    mass_per_length: Optional[Quantity] = None,
    torsional_stiffness: Optional[Quantity] = None,
) -> Section:
    """A part of the rod, from an arc length to another [m], that is stiffer or heavier."""
    return Section(
        **{
            "from": start,
            "to": end,
            "bending_stiffness": bending_stiffness,
            "mass_per_length": mass_per_length,
            "torsional_stiffness": torsional_stiffness,
        }
    )


_ROD_KEYS = (
    "length",
    "diameter",
    "material",
    "bending_stiffness",
    "mass_per_length",
    "torsional_stiffness",
    "natural_curvature",
    "natural_twist",
    "joint_stiffness",
    "joint_spacing",
)
_PART_KEYS = {
    "grippers": ("gripper", Gripper),
    "loads": ("load", Load),
    "obstacles": ("obstacle", Obstacle),
    "sections": ("section", Section),
}


class Scene:
    """A rod, what holds it, and what pulls at it. All numbers are in SI units, or text with a unit.

        dlo.Scene(length="2 m", diameter="6 mm", material="silicone",
                  grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")])

    material is a name (dlo.materials()) or {"youngs_modulus": "3 MPa", "density": 1150}. A rod may be
    given by bending_stiffness (EI [N m^2]; a pair about d1 and d2) and mass_per_length [kg/m]
    instead. force_model: a dict, or ForceModelSettings.

    Every field can be read (in SI units) and set (None: as if it had not been given). Whatever is
    set goes through the reader of scene files: a value out of range is an InputError that names
    the key at fault, and the scene stays as it was. Of fields that only fit together, replace()
    makes a scene with all of them changed at once.
    """

    def __init__(
        self,
        length: Quantity,
        *,
        diameter: Optional[Quantity] = None,
        material: Optional[Union[str, dict[str, Any]]] = None,
        grippers: Iterable[Gripper] = (),
        loads: Iterable[Load] = (),
        obstacles: Iterable[Obstacle] = (),
        sections: Iterable[Section] = (),
        gravity: Optional[Vector] = None,
        name: Optional[str] = None,
        bending_stiffness: Optional[Union[Quantity, Sequence[Quantity]]] = None,
        mass_per_length: Optional[Quantity] = None,
        torsional_stiffness: Optional[Quantity] = None,
        natural_curvature: Optional[Any] = None,
        natural_twist: Optional[Quantity] = None,
        joint_stiffness: Optional[Quantity] = None,
        joint_spacing: Optional[Quantity] = None,
        force_model: Optional[Union[dict[str, Any], ForceModelSettings]] = None,
    ) -> None:
        given = locals()
        rod = {key: given[key] for key in _ROD_KEYS if given[key] is not None}
        parts: dict[str, Iterable[Part]] = {key: given[key] for key in _PART_KEYS}
        settings = (
            force_model._table if isinstance(force_model, ForceModelSettings) else force_model
        )
        top = {"name": "scene" if name is None else name, "gravity": gravity}
        self._start("scene", top, rod, parts, {} if settings is None else settings)

    def _start(
        self,
        file: str,
        top: dict[str, Any],
        rod: dict[str, Any],
        parts: dict[str, Iterable[Part]],
        settings: dict[str, Any],
        data: Optional[_dlo.SceneData] = None,
    ) -> None:
        self._file = file
        self._top = {key: _copied(key, value) for key, value in top.items()}
        self._rod = {key: _copied(key, value) for key, value in rod.items()}
        self._parts = {key: self._adopted(key, some) for key, some in parts.items()}
        self._settings = _settings_of(settings)
        self._settings._owner = self
        self._data = data if data is not None else _dlo.read_scene(self._document(), file)

    def _adopted(self, key: str, parts: Iterable[Part]) -> tuple[Part, ...]:
        kind = _PART_KEYS[key][1]
        require(key, parts, LIST)
        adopted = []
        for part in parts:
            if not isinstance(part, kind):
                raise InputError(f"{key}: a {type(part).__name__} (allowed: {kind.__name__})", key)
            mine = kind(**part._table)
            mine._owner = self
            adopted.append(mine)
        return tuple(adopted)

    def _document(self) -> dict[str, Any]:
        document = dict(self._top)
        document["rod"] = self._rod
        for key, (name, _) in _PART_KEYS.items():
            if self._parts[key]:
                document[name] = [part._table for part in self._parts[key]]
        if self._settings._table:
            document["force_model"] = self._settings._table
        return document

    def _read_anew(self) -> None:
        self._data = _dlo.read_scene(self._document(), self._file)

    def _change(self, change: Callable[[], None]) -> None:
        before = (dict(self._top), dict(self._rod), dict(self._parts), self._settings)
        try:
            change()
            self._read_anew()
        except Exception:
            self._top, self._rod, self._parts, self._settings = before
            raise

    @classmethod
    def _from_document(
        cls, document: dict[str, Any], file: str, data: Optional[_dlo.SceneData]
    ) -> "Scene":
        parts: dict[str, Iterable[Part]] = {
            key: [kind(**table) for table in document.get(name, [])]
            for key, (name, kind) in _PART_KEYS.items()
        }
        top = {key: document[key] for key in ("name", "gravity") if key in document}
        scene = cls.__new__(cls)
        scene._start(
            file, top, document.get("rod", {}), parts, document.get("force_model", {}), data
        )
        return scene

    @classmethod
    def from_file(cls, path: Union[str, "os.PathLike[str]"]) -> "Scene":
        """Reads a scene file (TOML)."""
        if not isinstance(path, (str, bytes, os.PathLike)):
            raise InputError(
                f"scene: a {type(path).__name__} (allowed: a dlo.Scene, or the name of a scene file)"
            )
        # A name of a file may be of any bytes, that of a scene is Unicode.
        try:
            name = os.fsencode(path)
        except UnicodeEncodeError:
            raise InputError("scene: a file's name with half a character (allowed: Unicode)") from None
        if b"\0" in name:
            raise InputError("scene: a file's name with a zero byte (allowed: any other)")
        return cls.from_text(_dlo.read_file(name), name.decode(errors="replace"))

    @classmethod
    def from_text(cls, text: str, name: str = "scene") -> "Scene":
        """Reads a scene file's text. name: what messages call it."""
        require("text", text, TEXT)
        require("name", name, TEXT)
        data, document = _dlo.parse_scene(text, name)
        return cls._from_document(document, name, data)

    def to_toml(self) -> str:
        """The text of a scene file."""
        return _dlo.toml_text(self._document())

    def copy(self) -> "Scene":
        """The same scene, to be changed on its own."""
        return self._from_document(copy.deepcopy(self._document()), self._file, self._data)

    def replace(self, **fields: Any) -> "Scene":
        """A copy with other fields, all changed at once."""
        scene = self.copy()

        def change() -> None:
            for key, value in fields.items():
                scene._put(key, value)

        scene._change(change)
        return scene

    def _put(self, key: str, value: Any) -> None:
        if key in _ROD_KEYS or key in ("name", "gravity"):
            table = self._rod if key in _ROD_KEYS else self._top
            table.pop(key, None)
            if value is not None:
                table[key] = _copied(key, value)
        elif key in _PART_KEYS:
            self._parts[key] = self._adopted(key, value)
        elif key == "force_model":
            table = value._table if isinstance(value, ForceModelSettings) else value
            self._settings = _settings_of({} if table is None else table)
            self._settings._owner = self
        else:
            raise TypeError(f"a scene has no field {key}")

    def _put_one(self, key: str, value: Any) -> None:
        self._change(lambda: self._put(key, value))

    def __repr__(self) -> str:
        return f"<dlo.Scene {self.name!r}: {self.length:g} m, Gamma = {self.gamma:.4g}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.to_toml() == other.to_toml()

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return (Scene.from_text, (self.to_toml(), self._file))

    def _top_field(key: str, doc: str) -> property:  # type: ignore[misc]
        """A field whose value the reader knows in SI units."""
        return property(
            lambda self: getattr(self._data, key),
            lambda self, value: self._put_one(key, value),
            doc=doc,
        )

    def _rod_field(key: str, dimension: str, doc: str) -> property:  # type: ignore[misc]
        """A field that is as it was given, or None."""
        return property(
            lambda self: _number(self._rod.get(key), dimension),
            lambda self, value: self._put_one(key, value),
            doc=doc,
        )

    def _part_field(key: str, doc: str) -> property:  # type: ignore[misc]
        return property(
            lambda self: self._parts[key], lambda self, value: self._put_one(key, value), doc=doc
        )

    def _derived(key: str, doc: str) -> property:  # type: ignore[misc]
        return property(lambda self: getattr(self._data, key), doc=doc)

    name = _top_field("name", "For people.")
    gravity = _top_field("gravity", "[m/s^2], shape (3,).")
    length = _top_field("length", "Of the rod [m].")
    diameter = _top_field("diameter", "Of the rod [m]; 0: not known.")
    bending_stiffness = _top_field(
        "bending_stiffness", "EI [N m^2], given or of the material; about d1 of two."
    )
    mass_per_length = _top_field("mass_per_length", "rho A [kg/m], given or of the material.")
    torsional_stiffness = _rod_field(
        "torsional_stiffness", "section_stiffness", "GJ as given [N m^2], or None."
    )
    natural_curvature = _rod_field(
        "natural_curvature", "curvature", "As given [1/m]: k, [x, y], or rows of such; or None."
    )
    natural_twist = _rod_field("natural_twist", "twist", "As given [rad/m], or None.")
    joint_stiffness = _rod_field(
        "joint_stiffness", "joint_stiffness", "Of a chain's joints, as given [N m/rad], or None."
    )
    joint_spacing = _rod_field("joint_spacing", "length", "Of a chain, as given [m], or None.")
    grippers = _part_field("grippers", "A tuple of Gripper; set any iterable of them.")
    loads = _part_field("loads", "A tuple of Load.")
    obstacles = _part_field("obstacles", "A tuple of Obstacle.")
    sections = _part_field("sections", "A tuple of Section.")
    youngs_modulus = _derived("youngs_modulus", "E of the material [Pa]; 0: not known.")
    density = _derived("density", "Of the material [kg/m^3]; 0: not known.")
    axial_stiffness = _derived("axial_stiffness", "EA [N].")
    mass = _derived("mass", "Of the rod, with sections [kg].")
    gamma = _derived("gamma", "w l^3 / (EI) [-]: below 0.1 nearly straight, from 1000 on a rope.")
    planar = _derived("planar", "Whether grips, forces and obstacles in reach share a plane.")
    del _top_field, _rod_field, _part_field, _derived

    @property
    def material(self) -> Optional[Union[str, dict[str, Any]]]:
        """Its name, or a copy of its table; None of a rod that is given by EI and mass."""
        value: Optional[Union[str, dict[str, Any]]] = copy.deepcopy(self._rod.get("material"))
        return value

    @material.setter
    def material(self, value: Optional[Union[str, dict[str, Any]]]) -> None:
        self._put_one("material", value)

    @property
    def force_model(self) -> ForceModelSettings:
        """How it is stepped; set a dict or ForceModelSettings."""
        return self._settings

    @force_model.setter
    def force_model(self, value: Union[dict[str, Any], ForceModelSettings]) -> None:
        self._put_one("force_model", value)


def as_scene(scene: SceneLike) -> Scene:
    """The scene itself, or that of a file."""
    return scene if isinstance(scene, Scene) else Scene.from_file(scene)


def materials() -> list[dict[str, Any]]:
    """The materials that a scene can name: name, youngs_modulus [Pa], density [kg/m^3], source."""
    return _dlo.materials()
