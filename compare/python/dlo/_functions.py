"""What the command dlo does, on scenes and arrays."""

from __future__ import annotations

import itertools
from typing import Any, Iterable, Mapping, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _dlo
from ._arguments import (
    COUNT,
    INTEGER,
    LIST,
    NUMBER,
    QUANTITY,
    TABLE,
    TEXT,
    TEXTS,
    TRUTH,
    checked,
    require,
)
from ._documents import Benchmark, ForceModelFit, MaterialFit, Modes, Plan, Stability, Track
from ._errors import InputError
from ._scene import Quantity, Scene, SceneLike, as_scene

Shape = Union[ArrayLike, tuple[ArrayLike, ArrayLike]]
"""Points [m], shape (M, 3) or (M, 2), or a pair of these and their arc lengths [m], shape (M,)."""


def _many(scenes: Union[SceneLike, Iterable[SceneLike]]) -> list[Scene]:
    if isinstance(scenes, Scene) or isinstance(scenes, str) or hasattr(scenes, "__fspath__"):
        return [as_scene(scenes)]  # type: ignore[arg-type]
    require("scenes", scenes, LIST)
    return [as_scene(scene) for scene in scenes]  # type: ignore[union-attr]


def _si(value: Quantity, dimension: str) -> float:
    return _dlo.quantity(value, dimension) if isinstance(value, str) else float(value)


@checked(model=TEXT, samples=INTEGER)
def solve(
    scene: SceneLike, model: str = "energy", samples: Optional[int] = None, **limits: Any
) -> _dlo.Solution:
    """The shape of a scene's rod: `dlo solve`.

    model: "energy" (the lowest energy), "exact" (the rod's balance, shot), "chain" (the force model's
    polygon) or "force" (the force model, stepped to rest). samples: M points at equal arc lengths
    from 0 to l; None: 101 of energy and exact, the polygon's own points else. limits: time_limit [s],
    terms, max_evaluations, max_steps, rest_tolerance.

    Raises InputError, or ConvergenceError, whose result is the shape so far or None.
    """
    return _dlo.solve(as_scene(scene)._data, model, samples or 0, limits)


@checked(samples=INTEGER)
def solve_all(scene: SceneLike, samples: Optional[int] = None, **limits: Any) -> _dlo.Equilibria:
    """Every equilibrium that the energy model finds, with its stability: `dlo solve --all`."""
    return _dlo.solve_all(as_scene(scene)._data, samples or 0, limits)


@checked(
    tolerance=QUANTITY,
    measure=TEXT,
    min_seen=NUMBER,
    pose=TEXT,
    arc_lengths=TEXT,
    modulus=TRUTH,
    explain=TRUTH,
)
def check(
    scene: SceneLike,
    points: ArrayLike,
    *,
    arc_length: Optional[ArrayLike] = None,
    tolerance: Optional[Quantity] = None,
    measure: str = "rms",
    min_seen: Optional[float] = None,
    pose: str = "known",
    arc_lengths: str = "auto",
    modulus: bool = True,
    explain: bool = True,
    **limits: Any,
) -> _dlo.Check:
    """How far points are from the shape that the scene's rod would take: `dlo check`.

    points: positions along the rod [m], shape (M, 3) or (M, 2) with z = 0; from either end, stretches
    may be missing. arc_length: where along the rod they are [m], shape (M,), if that is known.
    tolerance: "1%" or 0.01 of the rod's length, or "2 mm"; the Check then passes or fails.
    measure: "rms" or "max", what is held against it. min_seen: the points are a part of the rod, and
    of less than this share no verdict passes; None: they are all of it. pose: what is unknown of
    the points' frame, "known" (nothing), "translation", "upright" or "rigid". arc_lengths: "auto",
    "file" (those given), "nearest" or "chord". modulus: look for E*/E. explain: of a shape that
    fails look for candidate causes, which takes longer than all else.
    """
    asked = (None if tolerance is None else str(tolerance), measure, min_seen, bool(explain))
    return _dlo.check(
        as_scene(scene)._data, points, arc_length, asked, pose, arc_lengths, bool(modulus), limits
    )


@checked(modulus=TRUTH)
def compare(scene: SceneLike, *, modulus: bool = True, **limits: Any) -> _dlo.Comparison:
    """How far the force model is from the energy model, and why: `dlo compare`."""
    return _dlo.compare(as_scene(scene)._data, bool(modulus), limits)


@checked(target=NUMBER, gripper_speed=NUMBER, time_limit=NUMBER)
def plan(
    scene: SceneLike,
    *,
    target: float = 1e-3,
    gripper_speed: float = 0.0,
    time_limit: float = 5.0,
) -> Plan:
    """What a scene needs, and bounds of what is neglected: `dlo solve --explain`.

    target: wanted RMS error over the rod's length. gripper_speed: how fast a gripper moves [m/s].
    time_limit: of all that the plan solves [s].
    """
    return Plan(*_dlo.plan(as_scene(scene)._data, target, gripper_speed, time_limit))


@checked(
    shapes=LIST,
    holdout=LIST,
    target=NUMBER,
    points=INTEGER,
    pose=TEXT,
    arc_lengths=TEXT,
    density=TRUTH,
    torsional_stiffness=TRUTH,
    natural_curvature=INTEGER,
    clamp_angles=QUANTITY,
    clamp_positions=QUANTITY,
    noise=QUANTITY,
    segments=INTEGER,
)
def calibrate(
    scenes: Union[SceneLike, Iterable[SceneLike]],
    shapes: Optional[Sequence[Shape]] = None,
    *,
    holdout: Iterable[SceneLike] = (),
    target: Optional[float] = None,
    points: Optional[int] = None,
    pose: str = "known",
    arc_lengths: str = "auto",
    density: bool = False,
    torsional_stiffness: bool = False,
    natural_curvature: int = 0,
    clamp_angles: Quantity = 0.0,
    clamp_positions: Quantity = 0.0,
    noise: Optional[Quantity] = None,
    segments: int = 0,
    **limits: Any,
) -> Union[MaterialFit, ForceModelFit]:
    """Young's modulus from measured shapes, or the force model's parameters: `dlo calibrate`.

    With shapes, one of each scene or several of one: a MaterialFit. A shape is an array of points
    [m], or a pair of points and their arc lengths. density, torsional_stiffness: fit these as well;
    natural_curvature: so many terms of it. clamp_angles, clamp_positions: how well the clamps are
    known (standard deviations, "5 deg", "2 mm"); each shape's own are then fitted. noise: standard
    deviation of one coordinate; None: estimated. segments: of your simulator's chain, whose springs are
    then found too ("chains" of the document). pose, arc_lengths: as of check().

    Without: a ForceModelFit of the scenes. holdout: scenes that only judge. target: RMS deviation
    wanted over the length (0.001 if not given). points: N; None: as the target needs.
    """
    data = [scene._data for scene in _many(scenes)]
    if shapes is None:
        held_out = [as_scene(scene)._data for scene in holdout]
        return ForceModelFit(*_dlo.calibrate_force_model(data, held_out, points, target, limits))
    pairs = [
        shape if isinstance(shape, tuple) and len(shape) == 2 else (shape, None) for shape in shapes
    ]
    what = {
        "pose": pose,
        "arc_lengths": arc_lengths,
        "density": bool(density),
        "torsional_stiffness": bool(torsional_stiffness),
        "natural_curvature_terms": natural_curvature,
        "clamp_angles": _si(clamp_angles, "angle"),
        "clamp_positions": _si(clamp_positions, "length"),
        "segments": segments,
        "noise": None if noise is None else _si(noise, "length"),
    }
    return MaterialFit(*_dlo.calibrate_material(data, pairs, what, limits))


def _spelled(field: str, value: Any, depth: int = 0) -> str:
    """As a scene file has it."""
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
    """A field and its values, which may be without end: one more than allowed is enough."""
    require("vary: a field", field, TEXT)
    if isinstance(values, str):
        require(f"vary: {field}", values, TEXT)
        return field, values
    require(f"vary: {field}", values, LIST)
    some = itertools.islice(values, _dlo.largest_table + 1)
    return field, [_spelled(f"vary: {field}", value) for value in some]


@checked(vary=TABLE, model=TEXT, threads=INTEGER)
def sweep(
    scene: SceneLike,
    vary: Mapping[str, Union[str, Iterable[Any]]],
    *,
    model: str = "energy",
    threads: int = 0,
    **limits: Any,
) -> dict[str, NDArray[Any]]:
    """All combinations of the values of some fields, as columns: `dlo sweep`.

    vary: of each field (a path in the scene file such as "rod.length" or "gripper.0.direction", or
    "gamma", which scales gravity) its values, numbers, vectors or text, or a range as the command
    takes it, "log:0.1:10:5". The last field changes fastest. model: "energy", "exact", "chain",
    "force", "compare" or "compare-chain". threads: 0: all cores.

    Returns a dict of arrays of shape (rows,), at most a million, by the names of the command's columns:
    float64 (to ten significant digits, NaN where there is none), or str. A row whose column "status"
    is not "ok" has no results.
    """
    made = as_scene(scene)
    fields = [_axis(field, values) for field, values in vary.items()]
    return _dlo.sweep(made.to_toml(), made._file, fields, model, threads, limits)


@checked(
    map=TEXT,
    case=TEXT,
    steppers=TEXTS,
    max_steps=COUNT,
    columns=INTEGER,
    rows=INTEGER,
    map_steps=COUNT,
    threads=INTEGER,
)
def stability(
    scene: Optional[SceneLike] = None,
    *,
    map: Optional[str] = None,
    case: str = "",
    steppers: Sequence[str] = (),
    max_steps: Optional[int] = None,
    columns: int = 16,
    rows: int = 32,
    map_steps: int = 20000,
    threads: int = 0,
) -> Stability:
    """Where the force model's steppers break: `dlo stability`.

    Without map: hard cases, those whose name contains `case`, with these steppers (all), of at most
    max_steps. map: "cF-cc" or "cF-ch", the largest stable c_F of a scene (None: the hard cases' rod),
    predicted and measured, on columns x rows rods of map_steps steps each.
    """
    if map is None:
        if scene is not None:
            raise InputError("stability: only a map takes a scene (allowed: map=\"cF-cc\")")
        return Stability(*_dlo.hard_cases(case, list(steppers), max_steps, threads))
    data = None if scene is None else as_scene(scene)._data
    return Stability(*_dlo.stability_map(data, map, columns, rows, map_steps, threads))


@checked(seconds=NUMBER, repeats=INTEGER)
def bench(
    scenes: Union[SceneLike, Iterable[SceneLike]] = (), *, seconds: float = 40.0, repeats: int = 5
) -> Benchmark:
    """What accuracy costs with every model: `dlo bench`.

    scenes: one or more; none: a steel rod and one a hundred times softer. seconds: of all runs.
    repeats: that a median is taken of.
    """
    return Benchmark(*_dlo.bench([scene._data for scene in _many(scenes)], seconds, repeats))


@checked(count=INTEGER, rate=NUMBER, damping=NUMBER, samples=INTEGER)
def modes(
    scene: SceneLike,
    *,
    count: int = 6,
    rate: float = 4000.0,
    damping: float = 0.01,
    samples: int = 41,
    **limits: Any,
) -> Modes:
    """Natural frequencies about a scene's shape: `dlo modes`.

    count: of modes, the slowest ones. rate: steps of the force model a second. damping: ratio of the
    slowest mode that the material has [-]. samples: points of each mode's shape.
    """
    found: Modes = _dlo.modes(
        as_scene(scene)._data, count, rate, damping, samples, Modes, limits
    )
    return found


@checked(
    begin=NUMBER,
    end=NUMBER,
    frame_rate=NUMBER,
    obstacle_rate=NUMBER,
    step_rate=NUMBER,
    force=TRUTH,
    dynamic=TRUTH,
    damping=NUMBER,
    drag=NUMBER,
    samples=INTEGER,
)
def track(
    scene: SceneLike,
    *,
    begin: Optional[float] = None,
    end: Optional[float] = None,
    frame_rate: Optional[float] = None,
    obstacle_rate: Optional[float] = None,
    step_rate: Optional[float] = None,
    force: bool = True,
    dynamic: bool = False,
    damping: float = 0.0,
    drag: float = 0.0,
    samples: int = 41,
    **limits: Any,
) -> Track:
    """The rod of a scene that moves, at rest at every time: `dlo track`.

    begin, end: of the motion [s]; None: the first and the last pose. frame_rate, obstacle_rate,
    step_rate: frames, moves of obstacles and steps of the force model a second; None: as the scene
    says. force: the force model beside it. dynamic: the rod with inertia too, from rest at the first
    pose; damping: its material's Kelvin-Voigt time [s], drag: the air's force per length and velocity
    [N s/m^2]. samples: M points of each frame.

    Raises InputError, or ConvergenceError where it had to stop, whose result is what was before.
    """
    if not dynamic and (damping != 0 or drag != 0):
        raise InputError("track: damping and drag are those of a rod with inertia (allowed: dynamic=True)")
    part = [begin, end, frame_rate, obstacle_rate, step_rate]
    loss = (damping, drag) if dynamic else None
    found: Track = _dlo.track(as_scene(scene)._data, part, bool(force), loss, samples, Track, limits)
    return found
