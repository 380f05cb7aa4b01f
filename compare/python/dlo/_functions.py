"""Functions of the command dlo for scenes and arrays of their shapes."""

from __future__ import annotations

from typing import Any, Iterable, Optional, Sequence, Union, overload, cast

import numpy
from numpy.typing import ArrayLike

from . import _dlo
from ._arguments import LIST, checked, require
from ._documents import ForceModelFit, MaterialFit, MotionCheck, MotionFit, Plan
from ._errors import InputError
from ._files import FileName, file_name
from ._scene import Calibrated, Quantity, Scene, SceneLike, data_of

__all__ = ["calibrate", "check", "compare", "plan", "solve", "solve_all"]

Shape = Union[ArrayLike, tuple[ArrayLike, ArrayLike], FileName]
"""Points [m], shape (M, 3) or (M, 2), or a pair of these and their arc lengths [m], shape (M,), or the
name of a file that has them."""


def is_file(value: Any) -> bool:
    return isinstance(value, (str, bytes)) or hasattr(value, "__fspath__")


def many(scenes: Union[SceneLike, Iterable[SceneLike]]) -> list[SceneLike]:
    if isinstance(scenes, Scene) or is_file(scenes):
        return [scenes]  # type: ignore[list-item]
    require("scenes", scenes, LIST)
    return list(scenes)  # type: ignore[arg-type]


def _pair(shape: Any) -> tuple[Any, Any]:
    """Returns points and their arc lengths, or None. A tuple of two points is no such pair."""
    return (file_name(shape, "shapes"), None) if is_file(shape) else shape_pair(shape)


def shape_pair(shape: Any) -> tuple[Any, Any]:
    """Returns points and their arc lengths, or None, for a shape that is no file."""
    if isinstance(shape, tuple) and len(shape) == 2 and _dimensions(shape[0]) != 1:
        return shape[0], shape[1]
    return shape, None


def _recorded(motion: Any) -> Any:
    """Returns the name of a file, or the rows of an array."""
    return file_name(motion, "motion") if is_file(motion) else numpy.asarray(motion, float).tolist()


def _dimensions(value: Any) -> int:
    """Returns the number of dimensions of an array; -1 for lists of different lengths."""
    try:
        return numpy.ndim(value)
    except ValueError:
        return -1


def _shapes(shapes: Any) -> list[Any]:
    """Returns each shape. Points, a pair of points and arc lengths, and a file are one shape."""
    if is_file(shapes) or _dimensions(shapes) == 2:
        return [shapes]
    require("shapes", shapes, LIST)
    pair = isinstance(shapes, tuple) and [_dimensions(part) for part in shapes] == [2, 1]
    return [shapes] if pair else list(shapes)


def _si(value: Quantity, dimension: str) -> float:
    return _dlo.quantity(value, dimension) if isinstance(value, str) else float(value)


@checked()
def solve(
    scene: SceneLike,
    model: Optional[str] = None,
    samples: Optional[int] = None,
    *,
    equilibrium: Optional[int] = None,
    near: Optional[Shape] = None,
    time: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> _dlo.Solution:
    """The shape of a scene's rod: `dlo solve`.

    model: "energy" (the lowest energy), "exact" (the rod's balance, shot), "chain" (the force model's
    polygon) or "force" (the force model, stepped to rest); None: "exact" of a scene with
    stretch = True, else "energy". samples: M points at equal arc lengths from 0 to l; None: 101 of
    energy and exact, the polygon's own points else. equilibrium: the number, from 1, of one of the
    equilibria that solve_all() lists, stable ones first, by energy. near: points, a pair of points and arc lengths, or
    the name of a file of these: the equilibrium of model energy that a local search from them leads to,
    in place of the lowest. time: of a scene that moves, as it is then [s]; None: at the first pose.
    materials: a file in which the name of a material is looked up instead. calibrated: a MaterialFit or MotionFit of
    calibrate(), or a file that `dlo calibrate -o` wrote: its rod, and how clamps and camera are held, in
    the place of the scene's.
    limits: time_limit [s], terms, max_evaluations, max_steps, rest_tolerance.

    Raises InputError, or ConvergenceError, whose result is the shape so far or None.
    """
    data = data_of(scene, materials, time, calibrated)
    from_points = None if near is None else _pair(near)
    return _dlo.solve(data, model or "", samples or 0, equilibrium, from_points, limits)


@checked()
def solve_all(
    scene: SceneLike,
    samples: Optional[int] = None,
    *,
    time: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> _dlo.Equilibria:
    """Every equilibrium that the energy model finds, with its stability: `dlo solve --all`.

    time, materials, calibrated: as of solve().
    """
    return _dlo.solve_all(data_of(scene, materials, time, calibrated), samples or 0, limits)


@overload
def check(scene: SceneLike, points: Union[ArrayLike, FileName], **options: Any) -> _dlo.Check: ...


@overload
def check(
    scene: SceneLike, points: None = None, *, motion: Union[ArrayLike, FileName], **options: Any
) -> MotionCheck: ...


@checked()
def check(
    scene: SceneLike,
    points: Optional[Union[ArrayLike, FileName]] = None,
    *,
    arc_length: Optional[ArrayLike] = None,
    tolerance: Optional[Quantity] = None,
    measure: str = "rms",
    min_seen: Optional[float] = None,
    register: str = "known",
    arc_lengths: str = "auto",
    modulus: bool = True,
    explain: bool = True,
    motion: Optional[Union[ArrayLike, FileName]] = None,
    dynamic: bool = False,
    damping: Optional[float] = None,
    drag: Optional[float] = None,
    quadratic_drag: Optional[float] = None,
    begin: Optional[float] = None,
    frame_rate: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Union[_dlo.Check, MotionCheck]:
    """How far points are from the shape that the scene's rod would take: `dlo check`.

    points: positions along the rod [m], shape (M, 3) or (M, 2) with z = 0; from either end, stretches
    may be missing; or the name of a file that `dlo check --shape` reads, in metres. arc_length: where along the rod they are [m], shape (M,), if that is known.
    tolerance: "1%" or 0.01 of the rod's length, "5% of deflection" (of a stiff rod, by its weight and loads),
    or "2 mm"; None: 1 % of the length. measure: "rms" or "max", what is held against it. min_seen: the points are a part of the rod, and
    of less than this share no verdict passes; None: they are all of it. register: what is unknown of
    the points' frame, "known" (nothing), "translation", "upright" or "rigid". arc_lengths: "auto",
    "file" (those given), "nearest" or "chord". modulus: look for E*/E. explain: of a shape that
    fails look for candidate causes, which takes longer than all else. materials,
    calibrated: as of solve().

    With motion in place of points a MotionCheck of a scene that moves: rows of time [s], arc length, x, y,
    z [m], shape (R, 5), or the name of a CSV file of these.
    dynamic: hold it against the rod with inertia, of that damping [s], drag [N s/m^2] and
    quadratic_drag [N s^2/m^3] (None: of calibrated, else 0), not at rest. begin: of the rod's motion [s]; None: the recording's.
    frame_rate: of the rod [Hz]; None: as needed.
    """
    what = locals()
    what["tolerance"] = None if tolerance is None else str(tolerance)
    if motion is not None:
        if points is not None:
            raise InputError("check: points and motion (allowed: one of them)")
        data = data_of(scene, materials, None, calibrated)
        return MotionCheck(*_dlo.check_motion(data, _recorded(motion), what, limits))
    if points is None:
        raise InputError("check: nothing to check (allowed: points, or motion)")
    data = data_of(scene, materials, None, calibrated)
    taken: Any = file_name(points, "points") if is_file(points) else points
    return _dlo.check(data, taken, arc_length, what, limits)


@checked()
def compare(
    scene: SceneLike,
    *,
    modulus: bool = True,
    plan: bool = False,
    time: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> _dlo.Comparison:
    """How far the force model is from the energy model, and why: `dlo compare`.

    modulus: look for E*/E. plan: make a plan too, as `dlo compare --explain` does, at the cost of some
    ten solves. time, materials, calibrated: as of solve().
    """
    return _dlo.compare(data_of(scene, materials, time, calibrated), modulus, plan, limits)


@checked()
def plan(
    scene: SceneLike,
    *,
    target: float = 1e-3,
    gripper_speed: float = 0.0,
    time_limit: float = 5.0,
    time: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
) -> Plan:
    """What a scene needs, and bounds of what is neglected: `dlo solve --explain`.

    target: wanted RMS error over the rod's length. gripper_speed: how fast a gripper moves [m/s].
    time_limit: of all that the plan solves [s]. time, materials, calibrated: as of solve().
    """
    return Plan(*_dlo.plan(data_of(scene, materials, time, calibrated), target, gripper_speed, time_limit))


_CALIBRATED_QUANTITIES = {
    "clamp_angles": "angle",
    "clamp_positions": "length",
    "clamp_rolls": "angle",
    "clamp_scatter": "angle",
    "camera_tilt": "angle",
    "noise": "length",
}


@checked(holdout=LIST)
def calibrate(
    scenes: Union[SceneLike, Iterable[SceneLike]],
    shapes: Optional[Union[Shape, Sequence[Shape]]] = None,
    *,
    holdout: Iterable[Union[SceneLike, Shape]] = (),
    target: Optional[float] = None,
    points: Optional[int] = None,
    register: str = "known",
    arc_lengths: str = "auto",
    density: bool = False,
    torsional_stiffness: bool = False,
    natural_curvature: int = 0,
    clamp_angles: Quantity = 0.0,
    clamp_positions: Quantity = 0.0,
    clamp_rolls: Quantity = 0.0,
    same_clamps: bool = False,
    clamp_scatter: Quantity = 0.0,
    camera_tilt: Quantity = 0.0,
    predict: bool = False,
    options: Optional[str] = None,
    noise: Optional[Quantity] = None,
    segments: int = 0,
    segment_lengths: Optional[Sequence[float]] = None,
    motion: Optional[Union[ArrayLike, FileName]] = None,
    time: Optional[float] = None,
    materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Union[MaterialFit, ForceModelFit, MotionFit]:
    """Young's modulus from measured shapes, or the force model's parameters: `dlo calibrate`.

    With shapes, one of each scene or several of one, or a single shape: a MaterialFit. A shape is an array of points
    [m], a tuple of points and their arc lengths, or the name of a file in metres. density, torsional_stiffness: fit these as well;
    natural_curvature: so many terms of it. clamp_angles, clamp_positions, clamp_rolls: how well the clamps are
    known (standard deviations, "5 deg", "2 mm"); each shape's own are then fitted,
    with same_clamps what all share, but for rolls, and with clamp_scatter each shape's own about it. camera_tilt: how level the camera is; one tilt of all shapes is then fitted. predict: each shape is left out in turn, and predicted. holdout: shapes that only judge, their scenes after the others ("held_out" of the document). options: "auto": where
    residuals are systematic, the terms of natural curvature, and clamps as said, alike or each on its own, that predict
    best ("tried" of the document); "given"; None: "auto" of three shapes or more, without these six. noise: standard deviation of one coordinate; None: estimated. segments: of your simulator's chain, whose springs are
    then found too ("chains" of the document); segment_lengths [m] where they are unequal. register, arc_lengths: as of check(). time, materials,
    calibrated: as of solve(), of all scenes.

    With motion, markers recorded on the rod of one scene that moves: a MotionFit with stiffness over
    mass and damping. It is an array of time [s], arc length, x, y, z [m] by row, or a file of these.

    Without: a ForceModelFit of the scenes. holdout: scenes that only judge. target: RMS deviation
    wanted over the length (0.001 if not given). points: N; None: as the target needs.
    """
    what = locals()
    data = [data_of(scene, materials, time, calibrated) for scene in many(scenes)]
    if motion is not None:
        if shapes is not None or len(data) != 1:
            raise InputError("calibrate: motion with shapes or of several scenes (allowed: one scene)")
        return MotionFit(*_dlo.calibrate_motion(data[0], _recorded(motion), "motion", limits))
    if shapes is None:
        held_out = [data_of(cast(SceneLike, scene), materials, time, calibrated) for scene in holdout]
        return ForceModelFit(*_dlo.calibrate_force_model(data, held_out, points, target, limits))
    for key, dimension in _CALIBRATED_QUANTITIES.items():
        if what[key] is not None:
            what[key] = _si(what[key], dimension)
    what["holdout"] = list(map(_pair, holdout))
    return MaterialFit(*_dlo.calibrate_material(data, list(map(_pair, _shapes(shapes))), what, limits))
