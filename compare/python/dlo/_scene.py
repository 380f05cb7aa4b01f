"""Scenes: from files, from text, or built in code."""

from __future__ import annotations

import json
from typing import Any, Iterable, Optional, Sequence, Union

from . import _dlo
from ._arguments import LIST, TABLE, TEXT, Attribute, Strict, require
from ._documents import MaterialFit, MotionFit
from ._errors import InputError
from ._files import FileName, Materials, file_name, file_text, materials_file
from ._parts import DistributedLoad, Field, ForceModelSettings, Gripper, Load, Medium, Obstacle, Part, Quantity
from ._parts import Section, Settings, TrackRates, Vector, copied, given, quantity

__all__ = ["Scene", "materials"]

SceneLike = Union["Scene", FileName]
"""A scene, or the name of a scene file."""

Calibrated = Union[MaterialFit, MotionFit, FileName]
"""Result of calibrate() for a rod and its fixture, or the name of its file."""


_ROD_KEYS = tuple(_dlo.scene_keys["rod"])
_TOP_KEYS = ("name", "gravity")
_PARTS: dict[str, type[Part]] = {
    "grippers": Gripper, "loads": Load, "distributed_loads": DistributedLoad, "obstacles": Obstacle, "sections": Section
}
_SETTINGS: dict[str, type[Settings]] = {"force_model": ForceModelSettings, "medium": Medium, "track": TrackRates}


def _from_reader(doc: str, derived: bool = False) -> Any:
    """Returns a field whose value the reader gives in SI units."""
    return Field(lambda scene, key: getattr(scene._data, key), doc, derived=derived)


def _own(doc: str) -> Any:
    """Returns a field that holds the parts or settings that belong to the scene."""
    return Field(lambda scene, key: scene._parts[key], doc)


class Scene(Strict):
    """A rod, what holds it, and what pulls at it. All numbers are in SI units, or text with a unit.

        dlo.Scene(length="2 m", diameter="6 mm", material="silicone",
                  grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")])

    material is a name (dlo.materials()) or {"youngs_modulus": "3 MPa", "density": 1150}. A tube has an inner_diameter
    too, a flat rod width (along d1) and thickness (along d2) instead. A rod may be given by bending_stiffness
    (EI [N m^2]; a pair about d1 and d2) and mass_per_length [kg/m] instead. A cable has layers instead, from the
    inside out, such as {"outer_diameter": "2 mm", "material": "copper"} or
    {"strands": 6, "strand_diameter": "2 mm", "material": "copper"}, and layer_bound "bonded" or "free".
    helix is {"radius": "2 cm", "pitch": "1 cm"} of the stress-free shape, pitch > 0 right-handed. rest_shape is a
    file of its points or the points themselves [m], shape (M, 3); shape (M, 6) has d1 of the frame there too.
    rest_shape_error and rest_shape_angle are the largest errors of the rod's arcs in points and d1. force_model,
    medium, track: a dict, or ForceModelSettings, Medium and TrackRates. materials: a file in which names of materials
    are looked up instead of the built-in one.

    Every field can be read (in SI units) and, unless it is derived, set (None: as if it had not been given). The reader
    of scene files checks the value: if it is out of range, InputError names the key, and the scene is unchanged.
    replace() returns a scene with several fields changed at once, for fields that are valid only together.
    """

    def __init__(
        self, length: Quantity, *, diameter: Optional[Quantity] = None, inner_diameter: Optional[Quantity] = None,
        width: Optional[Quantity] = None, thickness: Optional[Quantity] = None,
        material: Optional[Union[str, dict[str, Any]]] = None,
        grippers: Iterable[Gripper] = (), loads: Iterable[Load] = (), distributed_loads: Iterable[DistributedLoad] = (),
        obstacles: Iterable[Obstacle] = (), sections: Iterable[Section] = (),
        gravity: Optional[Vector] = None, name: Optional[str] = None,
        bending_stiffness: Optional[Union[Quantity, Sequence[Quantity]]] = None,
        mass_per_length: Optional[Quantity] = None, axial_stiffness: Optional[Quantity] = None,
        stretch: Optional[Union[bool, str]] = None, torsional_stiffness: Optional[Quantity] = None,
        natural_curvature: Optional[Any] = None, natural_twist: Optional[Quantity] = None,
        layers: Optional[Sequence[dict[str, Any]]] = None, layer_bound: Optional[str] = None,
        helix: Optional[dict[str, Quantity]] = None, rest_shape: Optional[Union[str, Any]] = None,
        joint_stiffness: Optional[Quantity] = None, joint_spacing: Optional[Quantity] = None,
        force_model: Optional[Union[dict[str, Any], ForceModelSettings]] = None,
        medium: Optional[Union[dict[str, Any], Medium]] = None,
        track: Optional[Union[dict[str, Any], TrackRates]] = None, materials: Optional[FileName] = None,
    ) -> None:
        fields = dict(locals(), name="scene" if name is None else name)
        del fields["self"], fields["materials"]
        self._start("scene", materials_file(materials), fields)

    def _start(
        self, file: str, materials: Materials, fields: dict[str, Any], data: Optional[_dlo.SceneData] = None
    ) -> None:
        self._file, self._materials = file, materials
        self._top: dict[str, Any] = {}
        self._table: dict[str, Any] = {}
        self._parts: dict[str, Any] = {}
        for key, value in {**dict.fromkeys((*_PARTS, *_SETTINGS)), **fields}.items():
            self._put(key, value)
        if data is None:
            self._read_anew()
        else:
            self._data = data

    def _adopted(self, key: str, kind: type[Part], part: Any) -> Part:
        if not isinstance(part, kind):
            raise InputError(f"{key}: a {type(part).__name__} (allowed: {kind.__name__})", key)
        mine = kind(**part._table)
        mine._owner = self
        return mine

    def _settings_of(self, key: str, value: Any) -> Part:
        kind = _SETTINGS[key]
        if not isinstance(value, kind):
            require(key, {} if value is None else value, TABLE)
            for one in value or ():
                require(f"{key}: a key", one, TEXT)
            value = kind(**(value or {}))
        return self._adopted(key, kind, value)

    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = {**self._top, "rod": self._table}
        for key, kind in _PARTS.items():
            if self._parts[key]:
                document[kind._name] = [part._table for part in self._parts[key]]
        for key in _SETTINGS:
            if self._parts[key]._table:
                document[key] = self._parts[key]._table
        return document

    def _read_anew(self) -> None:
        self._data = _dlo.read_scene(self._document(), self._file, self._materials)

    def _change(self, fields: dict[str, Any]) -> None:
        before = (dict(self._top), dict(self._table), dict(self._parts))
        try:
            for key, value in fields.items():
                self._put(key, value)
            self._read_anew()
        except Exception:
            self._top, self._table, self._parts = before
            raise

    @classmethod
    def _from_document(
        cls, document: dict[str, Any], file: str, materials: Materials, data: Optional[_dlo.SceneData] = None
    ) -> "Scene":
        fields: dict[str, Any] = {key: document[key] for key in (*_TOP_KEYS, *_SETTINGS) if key in document}
        fields.update(document.get("rod", {}))
        for key, kind in _PARTS.items():
            fields[key] = [kind(**table) for table in document.get(kind._name, [])]
        scene = cls.__new__(cls)
        scene._start(file, materials, fields, data)
        return scene

    @classmethod
    def _read(cls, text: str, name: str, materials: Materials) -> "Scene":
        data, document = _dlo.parse_scene(text, name, materials)
        return cls._from_document(document, name, materials, data)

    @classmethod
    def from_file(cls, path: FileName, *, materials: Optional[FileName] = None) -> "Scene":
        """Reads a scene file (TOML, or a MuJoCo model of a cable). materials: as in Scene."""
        name = file_name(path, "scene", "a dlo.Scene, or the name of a scene file")
        return cls._read(*file_text(name), materials_file(materials))

    @classmethod
    def from_text(cls, text: str, name: str = "scene", *, materials: Optional[FileName] = None) -> "Scene":
        """Reads the text of a scene file. name: name of the file in messages. materials: as in Scene."""
        require("text", text, TEXT)
        require("name", name, TEXT)
        return cls._read(text, name, materials_file(materials))

    def to_toml(self) -> str:
        """Returns the scene as the text of a scene file."""
        return _dlo.toml_text(self._document())

    def document(self, points: Optional[int] = None) -> dict[str, Any]:
        """Returns the scene in SI units with the quantities that follow from it: `dlo scene --format json`.
        points: N of the polygon in "force_model"; None: the scene's."""
        return json.loads(_dlo.scene_document(self._data, points))

    def copy(self) -> "Scene":
        """Returns an equal scene that can be changed independently."""
        return self._from_document(self._document(), self._file, self._materials, self._data)

    def _with_materials(self, path: FileName) -> "Scene":
        return self._from_document(self._document(), self._file, materials_file(path))

    def replace(self, **fields: Any) -> "Scene":
        """Returns a copy with other fields, all changed at once."""
        scene = self.copy()
        scene._change(fields)
        return scene

    def _put(self, key: str, value: Any) -> None:
        if key in _PARTS:
            parts = () if value is None else value
            require(key, parts, LIST)
            self._parts[key] = tuple(self._adopted(key, _PARTS[key], part) for part in parts)
        elif key in _SETTINGS:
            self._parts[key] = self._settings_of(key, value)
        elif key in _ROD_KEYS or key in _TOP_KEYS:
            table = self._table if key in _ROD_KEYS else self._top
            table.pop(key, None)
            if value is not None:
                table[key] = copied(key, value)
        else:
            raise TypeError(self._no_field(key))

    def _put_one(self, key: str, value: Any) -> None:
        self._change({key: value})

    def __repr__(self) -> str:
        return f"<dlo.Scene {self.name!r}: {self.length:g} m, Gamma = {self.gamma:.4g}>"

    def __eq__(self, other: object) -> bool:
        ours = (self.to_toml(), self._materials)
        return isinstance(other, Scene) and ours == (other.to_toml(), other._materials)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return (Scene._read, (self.to_toml(), self._file, self._materials))

    name = _from_reader("Title for people.")
    gravity = _from_reader("Gravity [m/s^2], shape (3,).")
    length = _from_reader("Length of the rod [m].")
    diameter = _from_reader("Diameter of the rod [m]; 0: not known.")
    inner_diameter = _from_reader("Inner diameter of a tube [m]; 0: solid.")
    width = _from_reader("Edge of a rectangular section along d1 [m]; 0: not rectangular.")
    thickness = _from_reader("Edge of a rectangular section along d2 [m]; 0: not rectangular.")
    bending_stiffness = _from_reader("EI [N m^2], given or of the material; about d1 if there are two.")
    mass_per_length = _from_reader("rho A [kg/m], given or of the material.")
    axial_stiffness = _from_reader("EA [N], given, of the material, or assumed.")
    torsional_stiffness = quantity("N m^2", "GJ as given [N m^2], or None.")
    natural_curvature = quantity("1/m", "Natural curvature as given [1/m]: k, [x, y], or rows of such; or None.")
    natural_twist = quantity("rad/m", "Natural twist as given [rad/m], or None.")
    rest_shape_error = _from_reader("Largest distance of rest_shape's points from the arcs [m]; NaN without.", True)
    rest_shape_angle = _from_reader("Largest angle of a given d1 from that of the arcs [rad]; NaN without.", True)
    joint_stiffness = quantity("N m/rad", "Stiffness of a chain's joints as given [N m/rad], or None.")
    joint_spacing = quantity("m", "Distance of a chain's joints as given [m], or None.")
    grippers = _own("A tuple of Gripper; set any iterable of them.")
    loads = _own("A tuple of Load.")
    distributed_loads = _own("A tuple of DistributedLoad.")
    obstacles = _own("A tuple of Obstacle.")
    sections = _own("A tuple of Section.")
    youngs_modulus = _from_reader("E of the material [Pa]; 0: not known.", True)
    density = _from_reader("Density of the material [kg/m^3]; 0: not known.", True)
    mass = _from_reader("Mass of the rod, with sections [kg].", True)
    gamma = _from_reader("w l^3 / (EI) [-]: below 0.1 nearly straight, from 1000 on a rope.", True)
    planar = _from_reader("Whether the rod stays in a plane that contains grips, forces and obstacles in reach.", True)
    material: Attribute[Optional[Union[str, dict[str, Any]]]] = given(
        "Name of the material, or a copy of its table, as given; or None."
    )
    layers = given("Layers of a cable as given: tables from the inside out; or None.")
    layer_bound: Attribute[Optional[str]] = given(
        'Bound of a cable as given: "bonded" or "free" to slip; or None, which is bonded.'
    )
    helix: Attribute[Optional[dict[str, Any]]] = given("Helix as given: a copy of its table; or None.")
    rest_shape = given("Stress-free shape as given: a file's name or points; or None.")
    force_model: Attribute[ForceModelSettings] = _own("Its settings; set a dict or ForceModelSettings.")
    medium: Attribute[Medium] = _own("Medium in which the rod is immersed; set a dict or Medium.")
    track: Attribute[TrackRates] = _own("Sampling rates of its motion; set a dict or TrackRates.")
    stretch: Attribute[Union[bool, str]] = given(
        'Whether model exact includes the axial strain, tension over EA; "auto": if it matters.', False
    )


def as_scene(scene: SceneLike, materials: Optional[FileName] = None) -> Scene:
    """Returns a scene, or the scene of a file; if a file of materials is given, the scene is read with it."""
    if not isinstance(scene, Scene):
        return Scene.from_file(scene, materials=materials)
    return scene if materials is None else scene._with_materials(materials)


def data_of(
    scene: SceneLike, materials: Optional[FileName] = None, time: Optional[float] = None,
    calibrated: Optional[Calibrated] = None,
) -> _dlo.SceneData:
    """Returns the extension's data of a scene. time: instant of a scene that moves [s]. calibrated: replaces its
    rod and clamps."""
    data = as_scene(scene, materials)._data
    if isinstance(calibrated, (MaterialFit, MotionFit)):
        data = _dlo.calibrated_scene(data, calibrated.to_toml(), "calibrated")
    elif calibrated is not None:
        name = file_name(calibrated, "calibrated", "a dlo.MaterialFit or dlo.MotionFit, or the name of its file")
        data = _dlo.calibrated_scene(data, *file_text(name))
    return data if time is None else _dlo.scene_at(data, time)


def materials(file: Optional[FileName] = None) -> list[dict[str, Any]]:
    """Returns the materials that a scene can name: name, youngs_modulus [Pa], density [kg/m^3], source.

    file: name of a file of materials; None: the built-in ones.
    """
    return _dlo.materials(materials_file(file))
