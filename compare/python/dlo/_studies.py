"""Functions of the command dlo for many scenes, and for scenes that move."""

from __future__ import annotations

import itertools
import os
from functools import partial
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import NDArray

from . import _dlo
from ._arguments import COUNT, LIST, NUMBER, TABLE, TEXT, checked, require
from ._documents import Benchmark, Modes, Regression, ScoreCard, Stability, Track
from ._errors import InputError
from ._files import FileName, file_name
from ._functions import as_scene_list, shape_pair
from ._scene import Calibrated, Quantity, Scene, SceneLike, as_scene, data_of
from ._time_limit import within

__all__ = ["bench", "modes", "regress", "stability", "suite", "sweep", "track"]


def _spelled(field: str, value: Any, depth: int = 0) -> str:
    """Returns a value as a scene file spells it."""
    if isinstance(value, str):
        require(field, value, TEXT)
        return value
    if isinstance(value, (list, tuple, numpy.ndarray)):
        if depth > 32:
            raise InputError(f"sweep: {field}: nested too deep (allowed: 32 levels)")
        return "[" + ", ".join(_spelled(field, one, depth + 1) for one in value) + "]"
    if isinstance(value, (bool, numpy.bool_)):
        raise InputError(f"sweep: {value} (allowed: numbers, vectors and text)")
    require(field, value, NUMBER)
    return repr(value.item() if isinstance(value, numpy.generic) else value)


def _axis(field: str, values: Union[str, Iterable[Any]]) -> tuple[str, Union[str, list[str]]]:
    """Returns a field and its values. They may be infinitely many: at most one more than allowed is read."""
    require("vary: a field", field, TEXT)
    if isinstance(values, str):
        require(f"vary: {field}", values, TEXT)
        return field, values
    require(f"vary: {field}", values, LIST)
    some = itertools.islice(values, _dlo.largest_table + 1)
    return field, [_spelled(f"vary: {field}", value) for value in some]


@checked(vary=TABLE)
def sweep(
    scene: SceneLike, vary: Mapping[str, Union[str, Iterable[Any]]], *, model: str = "energy", threads: int = 0,
    materials: Optional[FileName] = None, **limits: Any,
) -> dict[str, NDArray[Any]]:
    """Solves a scene with all combinations of the values of some fields: `dlo sweep`.

    vary: for each field (a path in the scene file such as "rod.length" or "gripper.0.direction", or
    "gamma", which scales gravity) its values, numbers, vectors or text, or a range as in the command,
    "log:0.1:10:5". The last field changes fastest. model: "energy", "exact", "chain", "force", "compare"
    or "compare-chain". threads: number of threads; 0: all cores. materials: as in solve().

    Returns a dict of arrays of shape (rows,), at most a million, by the names of the command's columns: "row" int64;
    "status", "optimum" and a field with a value that is no number str ("" where there is none); all others float64,
    with all digits (NaN where there is none). A row whose column "status" is not "ok" has no results.
    """
    what = locals()
    made = as_scene(scene, materials)
    fields = [_axis(field, values) for field, values in vary.items()]
    return _dlo.sweep(made.to_toml(), made._file, made._materials, fields, what, limits)


@checked(max_steps=COUNT)
def stability(
    scene: Optional[SceneLike] = None, *, map: Optional[str] = None, case: str = "", steppers: Sequence[str] = (),
    max_steps: Optional[int] = None, columns: int = 16, rows: int = 32, map_steps: int = 20000, threads: int = 0,
) -> Stability:
    """Tests the stability of the force model's steppers: `dlo stability`.

    Without map: runs the hard cases whose name contains `case`, with these steppers (none: all), of at most
    max_steps each. map: "cF-cc" or "cF-ch", the largest stable c_F of a scene (None: the hard cases' rod),
    predicted and measured, with columns x rows rods of map_steps steps each. threads: 0: all cores.
    """
    if map is None:
        if scene is not None:
            raise InputError("stability: only a map takes a scene (allowed: map=\"cF-cc\")")
        return Stability(_dlo.hard_cases(case, list(steppers), max_steps, threads))
    data = None if scene is None else data_of(scene)
    return Stability(_dlo.stability_map(data, map, columns, rows, map_steps, threads))


@checked()
def bench(
    scenes: Union[SceneLike, Iterable[SceneLike]] = (), *, seconds: float = 40.0, repeats: int = 5
) -> Benchmark:
    """Measures speed and error of all models: `dlo bench`.

    scenes: one or more; none: a steel rod and one a hundred times softer. seconds: time for all runs.
    repeats: runs per median.
    """
    return Benchmark(_dlo.bench(list(map(data_of, as_scene_list(scenes))), seconds, repeats))


@checked()
def regress(
    scenes: Union[SceneLike, Iterable[SceneLike]], baseline: FileName, *, update: bool = False, model: str = "force",
    relative: float = 0.01, absolute: float = 1e-6, tolerance: Optional[Quantity] = None, programs: Sequence[str] = (),
    time: Optional[float] = None, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Regression:
    """Compares shape errors with a baseline under version control: `dlo regress`.

    baseline: name of its file. update: whether it is replaced by these scenes' errors alone. model: "force" or "chain".
    An error may grow by the fraction relative of the baseline's plus the fraction absolute of the rod's length.
    tolerance: instead of absolute, "1%" of the length or "5% of deflection" (of a stiff rod, by its weight and loads).
    programs: other programs, "NAME=COMMAND" as in the command's --with. time, materials, calibrated: as in solve().

    Raises InputError, or ConvergenceError where a scene of an update is not solved and the baseline is left as it was.
    """
    what = locals()
    data = [data_of(scene, materials, time, calibrated) for scene in as_scene_list(scenes)]
    what["tolerance"] = None if tolerance is None else str(tolerance)
    file = file_name(baseline, "baseline")
    name = os.fsdecode(file) if update else ""

    return _dlo.regress(data, file, update, what, partial(Regression, _update=name), limits)


@checked()
def suite(
    run: Callable[[Scene, int], Any], *, name: Optional[str] = None, scenes: Sequence[str] = (), points: int = 16,
    threads: int = 0, time_limit: float = 60.0, state: Optional[FileName] = None, baseline: Optional[FileName] = None,
    update: bool = False, relative: float = 0.01, absolute: float = 1e-6,
) -> ScoreCard:
    """Makes the score card of a simulator that is a function: `dlo suite --with`.

    run(scene, N) returns the rod at rest as points [m], shape (N, 3), as a pair of these and their arc lengths [m],
    shape (N,), or as an object with both (a dlo.Solution). N is points, then 2 and 4 times as many. scene.document(N)
    is the scene in SI units, as for other programs. NotImplementedError means that the scene is not supported; any
    other exception is a failure, and the card states it. One call is made at a time, from any thread.

    name: name of the card; None: the function's. scenes: classes, or names of scenes; none: all. threads: for other
    computations; 0: all cores. time_limit: limit of each run, and of each reference [s]; a run beyond it is a failure.
    It is ended between two instructions of Python, after the current call of C. state: a folder that keeps finished
    runs by name, scene and N; they are not run again. Use another folder if the function has changed. baseline: a file
    as for regress(); the ScoreCard then passes or fails. update: whether the errors of these scenes are written into
    it. An error may grow by the fraction relative of the baseline's plus the fraction absolute of the rod's length.
    """
    what = locals()
    if not callable(run):
        raise InputError(f"run: a {type(run).__name__} (allowed: a function of a scene and a number of points)")

    limited = within(time_limit, run)

    def called(text: str, file: str, count: int) -> Any:
        made = limited(Scene.from_text(text, file), count)
        if hasattr(made, "points") and hasattr(made, "arc_length"):
            return made.points, made.arc_length
        return shape_pair(made)

    what["state"] = b"" if state is None else file_name(state, "state", "the name of a folder")
    what["baseline"] = b"" if baseline is None else file_name(baseline, "baseline")
    title = str(getattr(run, "__name__", "run")) if name is None else name
    return _dlo.suite(called, title, what, ScoreCard)


@checked()
def modes(
    scene: SceneLike, *, count: int = 6, rate: float = 4000.0, damping: float = 0.01, samples: int = 41,
    time: Optional[float] = None, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None,
    **limits: Any,
) -> Modes:
    """Computes natural frequencies about a scene's shape: `dlo modes`.

    count: number of modes, the slowest ones. rate: steps of the force model per second. damping: damping ratio
    of the slowest mode by the material [-], for c_h. samples: points of each mode's shape. time, materials,
    calibrated: as in solve().
    """
    what = locals()
    return _dlo.modes(data_of(scene, materials, time, calibrated), what, Modes, limits)


@checked()
def track(
    scene: SceneLike, *, begin: Optional[float] = None, end: Optional[float] = None, frame_rate: Optional[float] = None,
    obstacle_rate: Optional[float] = None, step_rate: Optional[float] = None, force: bool = True, dynamic: bool = False,
    damping: Optional[float] = None, drag: Optional[float] = None, quadratic_drag: Optional[float] = None,
    samples: int = 41, materials: Optional[FileName] = None, calibrated: Optional[Calibrated] = None, **limits: Any,
) -> Track:
    """Follows the rod of a scene that moves, at rest at every time: `dlo track`.

    begin, end: interval of the motion [s]; None: from the start of a recording in track.start, else the first pose,
    to the last pose. frame_rate, obstacle_rate, step_rate: frames, moves of obstacles and steps of the force model per
    second; None: the scene's. force: whether the force model is run too. dynamic: whether the rod with inertia is
    simulated too, from track.start, else from equilibrium with the velocities with which equilibria follow the
    grippers; damping: Kelvin-Voigt time of its material [s]; drag: force of the air per length and velocity [N s/m^2];
    quadratic_drag: force across the rod per length and squared velocity [N s^2/m^3]; None: of calibrated, else 0.
    samples: M points of each frame. materials, calibrated: as in solve().

    Raises InputError, or ConvergenceError if it had to stop; its result is the motion until then.
    """
    what = locals()
    if not dynamic and (damping or drag or quadratic_drag):
        raise InputError("track: damping and drag are those of a rod with inertia (allowed: dynamic=True)")
    return _dlo.track(data_of(scene, materials, None, calibrated), what, Track, limits)
