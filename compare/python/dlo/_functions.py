"""Functions of the command dlo for scenes and arrays of their shapes."""

from __future__ import annotations

from typing import Any, Iterable, Optional, Sequence, Union, overload, cast

import numpy
from numpy.typing import ArrayLike

from . import _dlo
from ._arguments import LIST, checked, require
from ._documents import Check, Comparison, Equilibria, ForceModelFit, MaterialFit, MotionCheck, MotionFit, Plan
from ._errors import InputError
from ._files import FileName, file_name
from ._parts import Quantity, number_of
from ._scene import Calibrated, Scene, SceneLike, data_of

__all__ = ["calibrate", "check", "compare", "plan", "solve", "solve_all"]

Shape = Union[ArrayLike, tuple[ArrayLike, ArrayLike], FileName]
"""Points [m], shape (M, 3) or (M, 2), or a pair of these and their arc lengths [m], shape (M,), or the
name of a file that has them."""


def is_file(value: Any) -> bool:
    return isinstance(value, (str, bytes)) or hasattr(value, "__fspath__")


def as_scene_list(scenes: Union[SceneLike, Iterable[SceneLike]]) -> list[SceneLike]:
    if isinstance(scenes, Scene) or is_file(scenes):
        return [scenes]  # type: ignore[list-item]
    require("scenes", scenes, LIST)
    return list(scenes)  # type: ignore[arg-type]


def _pair(shape: Any) -> tuple[Any, Any]:
    """Returns points, or the encoded name of a file, and their arc lengths or None."""
    return (file_name(shape, "shapes"), None) if is_file(shape) else shape_pair(shape)


def shape_pair(shape: Any) -> tuple[Any, Any]:
    """Returns points and their arc lengths or None, for a shape that is no file. A tuple of two points is no pair."""
    if isinstance(shape, tuple) and len(shape) == 2 and _dimensions(shape[0]) != 1:
        return shape[0], shape[1]
    return shape, None


def _recorded(motion: Any) -> Any:
    """Returns the encoded name of a file, or the rows of an array."""
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


@checked()
def solve(
    scene: SceneLike, model: Optional[str] = None, samples: Optional[int] = None, *, equilibrium: Optional[int] = None,
    near: Optional[Shape] = None, time: Optional[float] = None, materials: Optional[FileName] = None,
    calibrated: Optional[Calibrated] = None, **limits: Any,
) -> _dlo.Solution:
    """Returns the shape of a scene's rod: `dlo solve`.

    model: "energy" (the lowest energy), "exact" (the rod's balance, by shooting), "chain" (the lowest energy of the
    force model's polygon) or "force" (the force model, stepped to rest); None: "exact" for a scene with stretch = True,
    else "energy". samples: M points at equal arc lengths from 0 to l; None: 101 for energy and exact, else the
    polygon's own points. equilibrium: number, from 1, of an equilibrium in the list of solve_all(). near: points, a
    pair of points and arc lengths, or the name of a file of these: model energy then returns the equilibrium to which
    a local search from them leads, instead of the lowest. time: time of a scene that moves [s]; None: of the first
    pose. materials: file in which the name of a material is looked up instead of the built-in one. calibrated: a
    MaterialFit or MotionFit of calibrate(), or a file that `dlo calibrate -o` wrote: its rod, clamps and camera
    replace those of the scene. limits: time_limit [s], terms, max_evaluations, max_steps, rest_tolerance.

    Raises InputError, or ConvergenceError, whose result is the shape so far or None.
    """
    data = data_of(scene, materials, time, calibrated)
    from_points = None if near is None else _pair(near)
    return _dlo.solve(data, model or "", samples or 0, equilibrium, from_points, limits)


@checked()
def solve_all(
    scene: SceneLike, samples: Optional[int] = None, *, time: Optional[float] = None,
    materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None, **limits: Any,
) -> Equilibria:
    """Returns every equilibrium that the energy model finds, with its stability: `dlo solve --all`.

    samples, time, materials, calibrated: as in solve().
    """
    return _dlo.solve_all(data_of(scene, materials, time, calibrated), samples or 0, Equilibria, limits)


@overload
def check(scene: SceneLike, points: Union[ArrayLike, FileName], **options: Any) -> Check: ...


@overload
def check(
    scene: SceneLike, points: None = None, *, motion: Union[ArrayLike, FileName], **options: Any
) -> MotionCheck: ...


@checked()
def check(
    scene: SceneLike, points: Optional[Union[ArrayLike, FileName]] = None, *, arc_length: Optional[ArrayLike] = None,
    tolerance: Optional[Quantity] = None, measure: str = "rms", min_seen: Optional[float] = None,
    register: str = "known", arc_lengths: str = "auto", modulus: bool = True, explain: bool = True,
    motion: Optional[Union[ArrayLike, FileName]] = None, dynamic: bool = False, damping: Optional[float] = None,
    drag: Optional[float] = None, quadratic_drag: Optional[float] = None, begin: Optional[float] = None,
    frame_rate: Optional[float] = None, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Union[Check, MotionCheck]:
    """Compares points with the shape that the scene's rod would take: `dlo check`.

    points: positions in order along the rod, from either end [m], shape (M, 3), or (M, 2) with z = 0; parts of the rod
    may be missing; or the name of a file that `dlo check --shape` reads, in metres. arc_length: arc lengths of the
    points [m], shape (M,), if they are known. tolerance: "1%" or 0.01 of the rod's length, "5% of deflection" (of a
    stiff rod, by its weight and loads), or "2 mm"; None: 1 % of the length. measure: "rms" or "max", the deviation that
    is compared with the tolerance. min_seen: for points on a part of the rod, which then alone is judged: smallest
    fraction of the rod that has to be observed to pass; None: the whole rod is judged. register: unknown part of the
    points' frame: "known" (nothing), "translation", "upright" (and the rotation about the vertical) or "rigid".
    arc_lengths: "auto", "file" (the given ones), "nearest" or "chord". modulus: whether E*/E is computed. explain:
    whether causes are searched for if the verdict is "fail", which takes longer than all else. materials, calibrated:
    as in solve().

    With motion instead of points: returns a MotionCheck of a scene that moves. motion: rows of time [s], arc length, x,
    y, z [m], shape (R, 5), or the name of a CSV file of these. tolerance: no share of the deflection. dynamic: whether
    the rod has inertia, with damping [s], drag [N s/m^2] and quadratic_drag [N s^2/m^3] (None: of calibrated, else 0),
    or is at rest at every time. begin: start time of the rod's motion [s]; None: that of a recording in track.start,
    else the first time of motion. frame_rate: frame rate of the rod [Hz]; None: as needed. explain: whether causes are
    searched for, whatever the verdict is.
    """
    what = locals()
    what["tolerance"] = None if tolerance is None else str(tolerance)
    if motion is not None:
        if points is not None:
            raise InputError("check: points and motion (allowed: one of them)")
        data = data_of(scene, materials, None, calibrated)
        return MotionCheck(_dlo.check_motion(data, _recorded(motion), what, limits))
    if points is None:
        raise InputError("check: nothing to check (allowed: points, or motion)")
    data = data_of(scene, materials, None, calibrated)
    taken: Any = file_name(points, "points") if is_file(points) else points
    return Check(_dlo.check(data, taken, arc_length, what, limits))


@checked()
def compare(
    scene: SceneLike, *, modulus: bool = True, plan: bool = False, time: Optional[float] = None,
    materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None, **limits: Any,
) -> Comparison:
    """Compares the force model with the energy model and states the causes of their distance: `dlo compare`.

    modulus: whether E*/E is computed. plan: whether a plan is made too, as by `dlo compare --explain`, which
    takes about ten solves. time, materials, calibrated: as in solve().
    """
    return _dlo.compare(data_of(scene, materials, time, calibrated), modulus, plan, Comparison, limits)


@checked()
def plan(
    scene: SceneLike, *, target: float = 1e-3, gripper_speed: float = 0.0, time_limit: float = 5.0,
    time: Optional[float] = None, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None,
) -> Plan:
    """Plans how to solve a scene, with bounds of the effects that are neglected: `dlo solve --explain`.

    target: requested RMS error divided by the rod's length. gripper_speed: speed of a gripper [m/s].
    time_limit: limit for all solves of the plan [s]. time, materials, calibrated: as in solve().
    """
    return Plan(_dlo.plan(data_of(scene, materials, time, calibrated), target, gripper_speed, time_limit))


_CALIBRATED_QUANTITIES = {
    "clamp_angles": "angle", "clamp_positions": "length", "clamp_rolls": "angle", "clamp_scatter": "angle",
    "camera_tilt": "angle", "noise": "length",
}


@checked(holdout=LIST)
def calibrate(
    scenes: Union[SceneLike, Iterable[SceneLike]], shapes: Optional[Union[Shape, Sequence[Shape]]] = None, *,
    holdout: Iterable[Union[SceneLike, Shape]] = (), target: Optional[float] = None, points: Optional[int] = None,
    register: str = "known", arc_lengths: str = "auto", density: bool = False, torsional_stiffness: bool = False,
    natural_curvature: int = 0, clamp_angles: Quantity = 0.0, clamp_positions: Quantity = 0.0,
    clamp_rolls: Quantity = 0.0, same_clamps: bool = False, clamp_scatter: Quantity = 0.0, camera_tilt: Quantity = 0.0,
    predict: bool = False, options: Optional[str] = None, noise: Optional[Quantity] = None, segments: int = 0,
    segment_lengths: Optional[Sequence[float]] = None, motion: Optional[Union[ArrayLike, FileName]] = None,
    time: Optional[float] = None, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Union[MaterialFit, ForceModelFit, MotionFit]:
    """Fits Young's modulus to measured shapes, or the force model's parameters to the rod: `dlo calibrate`.

    With shapes: returns a MaterialFit. shapes: one of each scene, several of one scene, or a single shape: an array of
    points [m], a tuple of points and their arc lengths, or the name of a file in metres. density, torsional_stiffness:
    whether these are fitted as well. natural_curvature: number of its terms that are fitted as well. clamp_angles,
    clamp_positions, clamp_rolls: standard deviations of the clamps, such as "5 deg" or "2 mm"; if > 0, the clamps of
    each shape are fitted, or with same_clamps (except for rolls) those that all shapes share, and with clamp_scatter,
    a standard deviation too, the differences of each shape's directions from them. camera_tilt: standard deviation of
    the camera's tilt; if > 0, one tilt of all shapes is fitted. predict: whether each shape is predicted from the
    others. holdout: shapes that are judged, not fitted ("held_out" of the document); their scenes follow those of the
    others. options: "auto": if residuals are systematic, the terms of natural curvature and the errors of clamps, none,
    shared or of each shape, are those that predict best ("tried" of the document); "given"; None: "auto" for three
    shapes or more if neither natural curvature nor errors of clamps are requested. noise: standard deviation of one
    coordinate; None: estimated. segments: number of segments of a chain whose springs are computed too ("chains" of the
    document); segment_lengths: their lengths [m], if unequal. register, arc_lengths: as in check(). time, materials,
    calibrated: as in solve(), for all scenes.

    With motion, markers recorded on the rod of one scene that moves: returns a MotionFit, with stiffness over mass and
    damping. motion: rows of time [s], arc length, x, y, z [m], shape (R, 5), or the name of a CSV file of these.

    With neither: returns a ForceModelFit of the scenes. holdout: scenes that are judged, not fitted. target: requested
    RMS deviation divided by the length; None: 0.001. points: N; None: as the target requires (law hooke), or the
    scene's (law paper).
    """
    what = locals()
    data = [data_of(scene, materials, time, calibrated) for scene in as_scene_list(scenes)]
    if motion is not None:
        if shapes is not None or len(data) != 1:
            raise InputError("calibrate: motion with shapes or several scenes (allowed: motion with one scene)")
        return MotionFit(*_dlo.calibrate_motion(data[0], _recorded(motion), "motion", limits))
    if shapes is None:
        held_out = [data_of(cast(SceneLike, scene), materials, time, calibrated) for scene in holdout]
        return ForceModelFit(*_dlo.calibrate_force_model(data, held_out, points, target, limits))
    what.update((key, number_of(what[key], dimension)) for key, dimension in _CALIBRATED_QUANTITIES.items())
    what["holdout"] = list(map(_pair, holdout))
    return MaterialFit(*_dlo.calibrate_material(data, list(map(_pair, _shapes(shapes))), what, limits))
