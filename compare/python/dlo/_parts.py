"""Elements of a scene: tables of its file, whose keys are fields."""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _dlo
from ._arguments import Attribute, Strict, Value
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


def number_of(value: Any, unit: str) -> Any:
    """Returns a value of a document in this SI unit; for a list an array of its numbers."""
    if isinstance(value, str):
        return _dlo.quantity(value, unit)
    if isinstance(value, (list, tuple, numpy.ndarray)):
        array = numpy.array([number_of(one, unit) for one in value], dtype=float)
        array.flags.writeable = False
        return array
    return None if value is None else float(value)


def _unit(value: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, (list, tuple, numpy.ndarray)):
        vector = number_of(value, "")
        unit = vector / numpy.linalg.norm(vector)
    else:
        angle = number_of(value, "rad")
        unit = numpy.array([math.cos(angle), math.sin(angle), 0.0])
    unit.flags.writeable = False
    return unit


def as_it_is(value: Any) -> Any:
    """Returns a read-only copy of a value of a document."""
    if isinstance(value, dict):
        return _Fixed({key: as_it_is(one) for key, one in value.items()})
    return tuple(map(as_it_is, value)) if isinstance(value, (list, tuple)) else value


class Field(Attribute[Value]):
    """An attribute for a key of a scene or a part: read(owner, key) returns its value, owner._put_one(key, value) sets
    it unless it is derived. key: the key if it is not the attribute's name."""

    def __init__(self, read: Callable[[Any, str], Any], doc: str, key: str = "", derived: bool = False) -> None:
        self.key: str = key
        put = None if derived else lambda owner, value: owner._put_one(self.key, value)
        super().__init__(lambda owner: read(owner, self.key), put, doc=doc)

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)  # type: ignore[misc]
        self.key = self.key or name


def quantity(unit: str, doc: str, key: str = "") -> Any:
    """Returns a field whose value is the given one in this SI unit; None: it is not given."""
    return Field(lambda owner, key: number_of(owner._table.get(key), unit), doc, key)


def given(doc: str, default: Any = None) -> Any:
    """Returns a field whose value is a copy of the given one, or the default."""
    return Field(lambda owner, key: as_it_is(owner._table.get(key, default)), doc)


def _direction(doc: str) -> Any:
    return Field(lambda owner, key: _unit(owner._table.get(key)), doc)


class Part(Strict):
    """An element of a scene: a table of its file.

    Fields are read in SI units, and set to numbers in SI units or texts with a unit. A scene that contains
    the part is checked at once: a value out of range raises InputError that names the key, and the scene is
    unchanged. None removes a key.
    """

    _name = ""  # name of the table in a scene file

    def __init__(self, **table: Any) -> None:
        self._owner: Optional[Scene] = None
        self._table: dict[str, Any] = {}
        known = _dlo.scene_keys[self._name]
        for name, value in table.items():
            key = name if name in known else {"start": "from", "end": "to"}.get(name, name)
            if key not in known:
                near = _dlo.did_you_mean(name, known)
                name = f"{self._name}.{name}"
                raise InputError(f"scene: {name}: unknown key{near} (allowed: {', '.join(known)})", name)
            if value is not None:
                self._table[key] = copied(key, value)

    def _put_one(self, key: str, value: Any) -> None:
        before = dict(self._table)
        self._table.pop(key, None)
        if value is not None:
            self._table[key] = copied(key, value)
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
    """A clamp or a pin that holds a point of the rod; clamp() and pin() make one."""

    _name = "gripper"
    at = quantity("m", "Arc length that is held [m].")
    position = quantity("m", "Position of that point [m], shape (3,).")
    hold = given('"clamp" or "pin".', "clamp")
    direction = _direction("Direction of a clamp: unit vector along growing arc length, shape (3,).")
    roll = quantity("rad", "Rotation about the direction that the clamp holds [rad].")
    frame = quantity("", "Rows d1, d2, d3 that the clamp holds, shape (3, 3).")
    quaternion = quantity("", "Frame as a quaternion [w, x, y, z], shape (4,).")
    turns = given("Whole turns that are added to frame or quaternion.")
    pose = given("Poses of its motion: tables of time, position and, of clamps, direction and roll.")
    trajectory = given("Name of a CSV file of poses or two markers, in the scene's folder.")
    cutoff = quantity("Hz", "Frequency above which motion is removed from the file's poses [Hz].")


class Load(Part):
    """A force or the weight of a mass, and a couple, in space or rotating with the rod; load() makes one."""

    _name = "load"
    at = quantity("m", "Arc length [m].")
    force = quantity("N", "Force [N], shape (3,).")
    mass = quantity("kg", "Mass of a body that hangs there [kg], instead of a force.")
    torque = quantity("N m", "Couple [N m], shape (3,).")
    follows = given("Whether both have components along d1, d2, tangent, and rotate with them.")


class DistributedLoad(Part):
    """A force per length that keeps its direction; distributed_load() makes one."""

    _name = "distributed_load"
    start = quantity("m", "Where it begins [m] (`from` in a file); None: at 0.", "from")
    end = quantity("m", "Where it ends [m] (`to` in a file); None: at the rod's end.", "to")
    force_per_length = quantity("N/m", "Values [N/m], shape (3,); or (K, 3), from start to end.")


class Obstacle(Part):
    """A body that the rod cannot pass; obstacle() makes one."""

    _name = "obstacle"
    point = quantity("m", "Point of a plane, or centre of a body [m], shape (3,).")
    shape = given('"plane", "sphere", "cylinder", "capsule", "box".', "plane")
    normal = _direction("Normal of a plane, to the free side; for a box the direction of an edge.")
    axis = _direction("Axis of a cylinder or a capsule; for a box the direction of an edge.")
    radius = quantity("m", "Radius [m]; for a box that of its edges.")
    length = quantity("m", "Length of a capsule between the centres of its caps [m].")
    size = quantity("m", "Edges of a box [m], shape (3,).")
    stiffness = quantity("N/m^2", "Force per depth and length [N/m^2]; None: rigid.")
    friction = quantity("", "Coulomb's coefficient [-]; no model has it.")
    touches = given('"surface" or "axis" of the rod.', "surface")
    pose = given("Poses of its motion: tables of time and point.")
    trajectory = given("Name of a CSV file of poses, in the scene's folder.")
    cutoff = quantity("Hz", "Frequency above which motion is removed from the file's poses [Hz].")


class Section(Part):
    """An interval of the rod with other properties; section() makes one."""

    _name = "section"
    start = quantity("m", "Where it begins [m] (`from` in a file).", "from")
    end = quantity("m", "Where it ends [m] (`to` in a file).", "to")
    bending_stiffness = quantity("N m^2", "EI [N m^2].")
    mass_per_length = quantity("kg/m", "rho A [kg/m].")
    torsional_stiffness = quantity("N m^2", "GJ [N m^2].")
    natural_curvature = quantity("1/m", "Curvature of its stress-free shape [1/m]: k or [x, y].")
    natural_twist = quantity("rad/m", "Twist of its stress-free shape [rad/m].")


class Settings(Part):
    """A table of which a scene has one; it can be set to a dict. Fields that are not set have their default."""

    def _read(self, key: str) -> Any:
        return self._table.get(key) if self._owner is None else getattr(self._owner._data, self._name)[key]


def _setting(doc: str) -> Any:
    """Returns a field of a table that every scene has: read as the scene's reader returns it."""
    return Field(Settings._read, doc)


class ForceModelSettings(Settings):
    """Settings of the force model: scene.force_model."""

    _name = "force_model"
    points = _setting("Number of points N.")
    law = _setting('"hooke" (linear) or "paper" (cubic).')
    joint_law = _setting('Joint law of model chain: "linear", "binormal" or "hooke"; None: as law.')
    bookkeeping = _setting('"consistent" or "paper".')
    stepper = _setting('"auto", "basic", "limited", "relative", "dynamic", "verlet" or "implicit".')
    bending_rule = _setting("Rule for c_b of the law paper.")
    design_curvature = _setting("k of Formula 21 [1/m]; None: derived.")
    point_weight = _setting("Weight of every point [N]; None: derived.")
    c_b = _setting("[N]; None: derived.")
    c_c = _setting("[N]; None: derived.")
    c_F = _setting("[m/N]; None: derived.")
    c_h = _setting("[-]; None: derived.")
    l_s = _setting("[m]; None: derived.")


class Medium(Settings):
    """Medium in which the rod is immersed, with buoyancy, and with drag if it streams: scene.medium."""

    _name = "medium"
    density = quantity("kg/m^3", "Density [kg/m^3]; None: no buoyancy.")
    velocity = quantity("m/s", "Velocity of a steady stream [m/s], shape (3,); None: at rest.")
    normal_drag = quantity("", "Coefficient across the rod [-].")
    tangential_drag = quantity("", "Coefficient along the rod [-]; None: 0.")


class TrackRates(Settings):
    """Sampling rates, and the start of a rod with inertia, of a scene that moves: scene.track."""

    _name = "track"
    frame_rate = _setting("Frames per second [Hz].")
    obstacle_rate = _setting("Rate at which obstacles are moved [Hz]; None: in every frame.")
    start = _setting("File of a shape or a recording from which a rod with inertia starts; None: its equilibrium.")
    step_rate = _setting("Steps of the force model per second [Hz].")


def clamp(
    at: Quantity, position: Vector, direction: Optional[Direction] = None, *, roll: Optional[Quantity] = None,
    frame: Optional[ArrayLike] = None, quaternion: Optional[ArrayLike] = None, turns: Optional[int] = None,
) -> Gripper:
    """A gripper that holds position [m] and direction of the rod at an arc length [m].

    direction may be omitted if a frame or a quaternion is given; it is then their d3. roll (an angle), frame
    (rows d1, d2, d3) or quaternion [w, x, y, z] also keep the rod from rotating about its tangent; turns
    are whole turns that are added to frame or quaternion, which alone mean at most half a turn.
    """
    return Gripper(**locals())


def pin(at: Quantity, position: Vector) -> Gripper:
    """A gripper that holds the position [m] of the rod at an arc length [m]."""
    return Gripper(at=at, position=position, hold="pin")


def load(
    at: Quantity, force: Optional[Vector] = None, *, mass: Optional[Quantity] = None, torque: Optional[Vector] = None,
    follows: Optional[bool] = None,
) -> Load:
    """A force [N], or a mass [kg] that hangs, and a couple [N m], at an arc length [m].

    follows: force and torque are along d1, d2 and the tangent of the rod there, and turn with them.
    """
    return Load(**locals())


def distributed_load(
    force_per_length: Union[Vector, Sequence[Vector]], start: Optional[Quantity] = None, end: Optional[Quantity] = None
) -> DistributedLoad:
    """A force per length [N/m] from an arc length to another [m], or on the whole rod.

    Rows of three are forces per length at equal distances from start to end, linear between them.
    """
    return DistributedLoad(**locals())


def obstacle(
    point: Vector, normal: Optional[Vector] = None, *, shape: Optional[str] = None, axis: Optional[Vector] = None,
    radius: Optional[Quantity] = None, length: Optional[Quantity] = None, size: Optional[Vector] = None,
    stiffness: Optional[Quantity] = None, friction: Optional[float] = None, touches: Optional[str] = None,
) -> Obstacle:
    """A plane (point [m], normal to the free side), or a body whose centre is point.

    shape: "sphere" (radius), "cylinder" (axis, radius), "capsule" (axis, length, radius) or "box"
    (size, axis, normal, radius of its edges). stiffness [N/m^2]: None for a rigid obstacle.
    """
    return Obstacle(**locals())


def section(
    start: Quantity, end: Quantity, *, bending_stiffness: Optional[Union[Quantity, Sequence[Quantity]]] = None,
    mass_per_length: Optional[Quantity] = None, torsional_stiffness: Optional[Quantity] = None,
    natural_curvature: Optional[Union[Quantity, Sequence[Quantity]]] = None, natural_twist: Optional[Quantity] = None,
) -> Section:
    """An interval of the rod, from an arc length to another [m], with other properties or stress-free shape."""
    return Section(**locals())
