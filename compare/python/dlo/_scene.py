"""Scenes: from files, from text, or built in code."""

from __future__ import annotations

import inspect
import json
import operator
from typing import Any, Iterable, Optional, Union

from . import _dlo
from ._arguments import LIST, TABLE, TEXT, Strict, require
from ._documents import MaterialFit, MotionFit
from ._errors import InputError
from ._files import FileName, Materials, file_name, file_text, materials_file
from ._parts import DistributedLoad, ForceModelSettings, Gripper, Load, Medium, Obstacle, Part, Quantity
from ._parts import Section, TrackRates, field, store

__all__ = ["Scene", "materials"]

SceneLike = Union["Scene", FileName]
"""A scene, or the name of a scene file."""

Calibrated = Union[MaterialFit, MotionFit, FileName]
"""Result of calibrate() for a rod and its fixture, or the name of its file."""


_PARTS: dict[str, type[Part]] = {
    kind._name + "s": kind for kind in (Gripper, Load, DistributedLoad, Obstacle, Section)
}
_SETTINGS: dict[str, type[Part]] = {kind._name: kind for kind in (ForceModelSettings, Medium, TrackRates)}
_ROD = _dlo.scene_keys["rod"]
_TOP = {key: row for key, row in _dlo.scene_keys[""].items() if not row[0].startswith("table")}


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

    Fields are the keys of the file and of its table [rod]. Every field can be read in SI units and, unless it is
    derived, set (None: as if it had not been given). A dimension or a property of the material that the scene does not
    have is 0; any other key that is not given has its default, or None. The reader of scene files checks the value: if
    it is out of range, InputError names the key, and the scene is unchanged. replace() returns a scene with several
    fields changed at once, for fields that are valid only together.
    """

    def __init__(
        self, length: Quantity, *, grippers: Iterable[Gripper] = (), materials: Optional[FileName] = None, **fields: Any
    ) -> None:
        fields = {"name": "scene", "length": length, "grippers": grippers, **fields}
        self._start("scene", materials_file(materials), fields)

    def _start(
        self, file: str, materials: Materials, fields: dict[str, Any], data: Optional[_dlo.SceneData] = None
    ) -> None:
        self._file, self._materials = file, materials
        self._top: dict[str, Any] = {}
        self._table: dict[str, Any] = {}
        self._parts: dict[str, Any] = dict.fromkeys(_PARTS, ())
        for key, value in {**dict.fromkeys(_SETTINGS), **fields}.items():
            self._put(key, value)
        if data is None:
            self._reread()
        else:
            self._data = data

    def _owned_part(self, key: str, kind: type[Part], part: Any) -> Part:
        """Returns a copy of the part that belongs to this scene. Both share the values of keys, which never change."""
        if not isinstance(part, kind):
            raise InputError(f"{key}: a {type(part).__name__} (allowed: {kind.__name__})", key)
        mine = kind.__new__(kind)
        vars(mine).update(_owner=self, _table=dict(part._table))
        return mine

    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = {**self._top, "rod": self._table}
        for key, kind in _PARTS.items():
            if self._parts[key]:
                document[kind._name] = [part._table for part in self._parts[key]]
        for key in _SETTINGS:
            if self._parts[key]._table:
                document[key] = self._parts[key]._table
        return document

    def _reread(self) -> None:
        self._data = _dlo.read_scene(self._document(), self._file, self._materials)

    def _change(self, fields: dict[str, Any]) -> None:
        before = (dict(self._top), dict(self._table), dict(self._parts))
        try:
            for key, value in fields.items():
                self._put(key, value)
            self._reread()
        except Exception:
            self._top, self._table, self._parts = before
            raise

    @classmethod
    def _read(cls, text: str, name: str, materials: Materials) -> "Scene":
        data, document = _dlo.parse_scene(text, name, materials)
        fields = document.pop("rod", {})
        for key, value in document.items():
            kind = _PARTS.get(key + "s")
            fields[key + "s" if kind else key] = [kind(**table) for table in value] if kind else value
        scene = cls.__new__(cls)
        scene._start(name, materials, fields, data)
        return scene

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
        scene = Scene.__new__(Scene)
        vars(scene).update(vars(self), _top=dict(self._top), _table=dict(self._table), _parts={})
        for key, parts in self._parts.items():
            scene._put(key, parts)
        return scene

    def _with_materials(self, path: FileName) -> "Scene":
        scene = self.copy()
        scene._materials = materials_file(path)
        scene._reread()
        return scene

    def replace(self, **fields: Any) -> "Scene":
        """Returns a copy with other fields, all changed at once."""
        scene = self.copy()
        scene._change(fields)
        return scene

    def _put(self, key: str, value: Any) -> None:
        if key in _PARTS:
            parts = () if value is None else value
            require(key, parts, LIST)
            self._parts[key] = tuple(self._owned_part(key, _PARTS[key], part) for part in parts)
        elif key in _SETTINGS:
            kind = _SETTINGS[key]
            if not isinstance(value, kind):
                table = {} if value is None else value
                require(key, table, TABLE)
                for one in table:
                    require(f"{key}: a key", one, TEXT)
                value = kind(**table)
            self._parts[key] = self._owned_part(key, kind, value)
        elif key in _ROD or key in _TOP:
            store(self._table if key in _ROD else self._top, key, value)
        else:
            raise TypeError(self._no_field(key))

    def _set_validated(self, key: str, value: Any) -> None:
        self._change({key: value})

    def __repr__(self) -> str:
        return f"<dlo.Scene {self.name!r}: {self.length:g} m, Gamma = {self.gamma:.4g}>"

    def __eq__(self, other: object) -> bool:
        ours = (self.to_toml(), self._materials)
        return isinstance(other, Scene) and ours == (other.to_toml(), other._materials)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Any:
        return (Scene._read, (self.to_toml(), self._file, self._materials))


def _make_fields() -> None:
    """Gives Scene an attribute for each key, list of parts and derived value, and the signature that names the keys.
    The value of a key is that of the reader, if it has one."""
    keys = {**_TOP, **_ROD}
    for key, row in keys.items():
        read = operator.attrgetter(f"_data.{key}") if hasattr(_dlo.SceneData, key) else None
        setattr(Scene, key, field(key, row, read))
    for key, kind in {**_PARTS, **_SETTINGS}.items():
        row = _dlo.scene_keys[""][kind._name]
        setattr(Scene, key, field(key, row, lambda scene, key=key: scene._parts[key]))  # type: ignore[misc]
    for key, member in vars(_dlo.SceneData).items():
        if isinstance(member, property) and key not in keys:
            setattr(Scene, key, property(operator.attrgetter(f"_data.{key}"), doc=member.__doc__))
    named = [inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=None)
             for key in (*keys, *_PARTS, *_SETTINGS, "materials") if key != "length"]
    length = inspect.Parameter("length", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    setattr(Scene, "__signature__", inspect.Signature([length, *named]))


_make_fields()


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
