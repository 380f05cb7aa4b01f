"""Elements of a scene: tables of its file, whose keys are fields."""

from __future__ import annotations

import copy
import functools
import json
import math
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Union

import numpy
from numpy.typing import NDArray

from . import _dlo
from ._arguments import Strict
from ._errors import InputError

__all__ = [
    "DistributedLoad", "ForceModelSettings", "Gripper", "Load", "Medium", "Obstacle", "Section", "TrackRates",
    "clamp", "distributed_load", "load", "obstacle", "pin", "section",
]

if TYPE_CHECKING:
    from ._scene import Scene

Quantity = Union[float, str]
"""A number in SI units, or text with a unit: 0.006 or "6 mm"."""

Vector = Union[Sequence[Quantity], NDArray[Any]]
"""Three quantities, or a NumPy array of shape (3,)."""

Direction = Union[Quantity, Vector]
"""An angle in the x-y plane from +x ("30 deg", or a number in rad), or a vector of any length."""

class _Fixed(dict[str, Any]):
    """Copy of a table of a scene. It refuses changes, because they would have no effect on the scene."""

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError("a copy of what the scene has (allowed: to set the field to a whole new value)")

    __setitem__ = __delitem__ = __ior__ = update = _refuse  # type: ignore[assignment]
    setdefault = pop = popitem = clear = _refuse  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, Any]) -> dict[str, Any]:
        return {key: copy.deepcopy(value, memo) for key, value in self.items()}

    def __reduce__(self) -> Any:
        return dict, (dict(self),)


def copied(key: str, value: Any) -> Any:
    """Returns a copy of a value, which belongs to the scene."""
    try:
        return copy.deepcopy(value)
    except RecursionError:
        raise InputError(f"scene: {key}: nested too deep (allowed: 32 levels)", key) from None
    except (TypeError, copy.Error):
        allowed = "a number, text, a list, a table"
        raise InputError(f"scene: {key}: a {type(value).__name__} (allowed: {allowed})", key) from None


def number_of(value: Any, dimension: str) -> Any:
    """Returns a value of a document of this dimension in SI units; for a list an array of its numbers."""
    if isinstance(value, str):
        return _dlo.quantity(value, dimension)
    if isinstance(value, (list, tuple, numpy.ndarray)):
        array = numpy.array([number_of(one, dimension) for one in value], dtype=float)
        array.flags.writeable = False
        return array
    return None if value is None else float(value)


def _unit_vector(value: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, (list, tuple, numpy.ndarray)):
        vector = number_of(value, "number")
        unit = vector / numpy.linalg.norm(vector)
    else:
        angle = number_of(value, "angle")
        unit = numpy.array([math.cos(angle), math.sin(angle), 0.0])
    unit.flags.writeable = False
    return unit


def unchanged(value: Any) -> Any:
    """Returns a read-only copy of a value of a document."""
    if isinstance(value, dict):
        return _Fixed({key: unchanged(one) for key, one in value.items()})
    if isinstance(value, numpy.ndarray):
        value = value.view()
        value.flags.writeable = False
    return tuple(map(unchanged, value)) if isinstance(value, (list, tuple)) else value


def _default(form: str, allowed: str, missing: str) -> Any:
    """Returns the default of a key, None if its row describes it in words."""
    if form == "choice":
        return missing if missing in allowed.split(", ") else None
    try:
        return json.loads(missing)
    except ValueError:
        return None


def field(key: str, row: tuple[str, ...], reader: Optional[Callable[[Any], Any]] = None) -> property:
    """Returns an attribute for a key of a scene file: the value that is given in SI units, else the default, else
    None. row: of _dlo.scene_keys. reader: returns the value from its owner instead."""
    form, unit, allowed, missing, words = row
    read: Callable[[Any], Any] = unchanged
    if form in ("direction", "angle or vector"):
        read = _unit_vector
    elif form.split()[0].rstrip(",") in ("number", "vector", "three", "four"):
        read = functools.partial(number_of, dimension=form.split()[-1])
    default = read(_default(form, allowed, missing))

    def get(owner: Any) -> Any:
        value = owner._table.get(key)
        return default if value is None else read(value)

    doc = f"[{unit}] {words}" if unit else words
    return property(reader or get, lambda owner, value: owner._set_validated(key, value), doc=doc)


def store(table: dict[str, Any], key: str, value: Any) -> None:
    """Sets a key of a table; None removes it."""
    table.pop(key, None)
    if value is not None:
        table[key] = copied(key, value)


class Part(Strict):
    """An element of a scene: a table of its file.

    Fields are its keys. They are read in SI units, as given or else their default, and set to numbers in SI units or
    texts with a unit. A scene that contains the part is checked at once: a value out of range raises InputError that
    names the key, and the scene is unchanged. None removes a key.
    """

    _name = ""  # name of the table in a scene file

    def __init_subclass__(cls) -> None:
        for key, row in _dlo.scene_keys[cls._name].items():
            setattr(cls, {"from": "start", "to": "end"}.get(key, key), field(key, row))

    def __init__(self, **table: Any) -> None:
        self._owner: Optional[Scene] = None
        self._table: dict[str, Any] = {}
        known = _dlo.scene_keys[self._name]
        for name, value in table.items():
            key = name if name in known else {"start": "from", "end": "to"}.get(name, name)
            if key not in known:
                near = _dlo.did_you_mean(name, list(known))
                name = f"{self._name}.{name}"
                raise InputError(f"scene: {name}: unknown key{near} (allowed: {', '.join(sorted(known))})", name)
            store(self._table, key, value)

    def _set_validated(self, key: str, value: Any) -> None:
        before = dict(self._table)
        store(self._table, key, value)
        if self._owner is None:
            return
        try:
            self._owner._reread()
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
    """A clamp or a pin that holds a point of the rod; clamp() and pin() make one."""

    _name = "gripper"


class Load(Part):
    """A force or the weight of a mass, and a couple, in space or rotating with the rod; load() makes one."""

    _name = "load"


class DistributedLoad(Part):
    """A force per length that keeps its direction; distributed_load() makes one."""

    _name = "distributed_load"


class Obstacle(Part):
    """A body that the rod cannot pass; obstacle() makes one."""

    _name = "obstacle"


class Section(Part):
    """An interval of the rod with other properties; section() makes one."""

    _name = "section"


class ForceModelSettings(Part):
    """Settings of the force model: scene.force_model."""

    _name = "force_model"


class Medium(Part):
    """Medium in which the rod is immersed, with buoyancy, and with drag if it streams: scene.medium."""

    _name = "medium"


class TrackRates(Part):
    """Sampling rates, and the start of a rod with inertia, of a scene that moves: scene.track."""

    _name = "track"


def clamp(at: Quantity, position: Vector, direction: Optional[Direction] = None, **keys: Any) -> Gripper:
    """A gripper that holds position [m] and direction of the rod at an arc length [m]. keys: others of dlo.Gripper.

    direction may be omitted if a frame or a quaternion is given; it is then their d3. roll (an angle), frame
    (rows d1, d2, d3) or quaternion [w, x, y, z] also keep the rod from rotating about its tangent; turns
    are whole turns that are added to frame or quaternion, which alone mean at most half a turn.
    """
    return Gripper(at=at, position=position, direction=direction, **keys)


def pin(at: Quantity, position: Vector) -> Gripper:
    """A gripper that holds the position [m] of the rod at an arc length [m]."""
    return Gripper(at=at, position=position, hold="pin")


def load(at: Quantity, force: Optional[Vector] = None, **keys: Any) -> Load:
    """A force [N], or a mass [kg] that hangs, and a torque [N m], at an arc length [m]. keys: others of dlo.Load.

    follows: force and torque are along d1, d2 and the tangent of the rod there, and rotate with them.
    """
    return Load(at=at, force=force, **keys)


def distributed_load(
    force_per_length: Union[Vector, Sequence[Vector]], start: Optional[Quantity] = None, end: Optional[Quantity] = None
) -> DistributedLoad:
    """A force per length [N/m] from an arc length to another [m], or on the whole rod.

    Rows of three are forces per length at equal distances from start to end, linear between them.
    """
    return DistributedLoad(**locals())


def obstacle(point: Vector, normal: Optional[Vector] = None, **keys: Any) -> Obstacle:
    """A plane (point [m], normal to the free side), or a body whose centre is point. keys: others of dlo.Obstacle.

    shape: "sphere" (radius), "cylinder" (axis, radius), "capsule" (axis, length, radius) or "box"
    (size, axis, normal, radius of its edges). stiffness [N/m^2]: None for a rigid obstacle.
    """
    return Obstacle(point=point, normal=normal, **keys)


def section(start: Quantity, end: Quantity, **keys: Any) -> Section:
    """An interval of the rod, from an arc length to another [m], with other properties or another stress-free shape:
    keys of dlo.Section."""
    return Section(start=start, end=end, **keys)
