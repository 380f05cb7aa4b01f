"""Results that are documents of the command, with frequently used values as attributes."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Callable, Iterator, NamedTuple, Optional, Union

import numpy
from numpy.typing import NDArray

from . import _dlo, _plot, _show
from ._arguments import Attribute, Value
from ._errors import InputError

__all__ = [
    "Benchmark", "Check", "Comparison", "Document", "Equilibria", "ForceModelFit", "MaterialFit", "Modes",
    "MotionCheck", "MotionFit", "Plan", "Regression", "ScoreCard", "Stability", "Track",
]


def _found(value: Any, path: list[str]) -> Any:
    """Returns the value at a path of keys; for the key *, the list of the values in each element; for 0, the first."""
    for i, key in enumerate(path):
        if key == "*":
            return [_found(one, path[i + 1 :]) for one in value]
        value = value[0 if key == "0" else key]
    return value


def _at(path: str, kind: Callable[[Any], Value], doc: str) -> Attribute[Value]:
    """Returns an attribute that reads a document at a path, such as "frames/*/time_s"."""
    return Attribute(lambda self: kind(_found(self.json, path.split("/"))), doc=doc)


def _array(values: Any) -> NDArray[numpy.float64]:
    return numpy.array(values, dtype=float)


def _passes(verdict: Any) -> bool:
    return bool(verdict == "pass")


def _causes(values: Any) -> list[tuple[str, float]]:
    return [(cause["cause"], cause["rms_m"]) for cause in values]


def _or_nan(value: Any) -> float:
    return math.nan if value is None else float(value)


def _number(value: Any) -> Optional[float]:
    return None if value is None else float(value)


class _Kept(NamedTuple):
    """The part of a result that a pickled document keeps."""

    text: str
    json_text: str
    panel: Optional[dict[str, Any]]

    def __str__(self) -> str:
        return self.text

    def to_json(self) -> str:
        return self.json_text

    def _panel(self, in_space: Optional[bool]) -> Any:
        return self.panel


@dataclass(repr=False, eq=False)
class Document:
    """A result as the command writes it: str() is its text, json its JSON as a dict."""

    _made: Union[_dlo.Result, _Kept]

    @cached_property
    def json(self) -> dict[str, Any]:
        """The command's document, as a dict."""
        return json.loads(self.to_json())

    def to_json(self) -> str:
        """The command's document, as text."""
        return self._made.to_json()

    def __getstate__(self) -> dict[str, Any]:
        panel = self._made._panel(None) if isinstance(self, Drawn) else None
        return {**vars(self), "_made": _Kept(str(self), self.to_json(), panel)}

    def __getitem__(self, key: str) -> Any:
        return self.json[key]

    def __str__(self) -> str:
        return str(self._made)

    __repr__ = _show.line
    _repr_html_ = _show.html


class Drawn(Document):
    """A document with a picture."""

    def _panel(self, in_space: Optional[bool]) -> dict[str, Any]:
        return self._made._panel(in_space)

    def plot(self, ax: Any = None) -> Any:
        """Draws the shape with matplotlib, at equal aspect, or nine frames of a motion, row by row, or all if there are
        fewer. ax: the axes to draw into, new ones for None; returned."""
        return _plot.plot(self, ax)

    _repr_svg_ = _show.svg


class Plan(Document):
    """Plan for a scene, with bounds of the effects that are neglected; result of plan()."""


class Stability(Document):
    """Hard cases, or a map of the largest stable c_F; result of stability()."""


class Benchmark(Document):
    """Speed and error of all models; result of bench()."""


class Modes(Document):
    """The slowest modes of a scene's rod; result of modes()."""

    frequencies = _at("modes/*/frequency_Hz", _array, "Frequencies of the rod [Hz], shape (n,); NaN if unstable.")
    arc_length = _at("arc_length_m", _array, "Arc lengths of the points of the modes' shapes [m], shape (M,).")
    shapes = _at("modes/*/shape_m", _array, "Displacements of the modes, at most 1 m, shape (n, M, 3).")


def _moving(path: str, doc: str) -> Attribute[NDArray[numpy.float64]]:
    """Returns an attribute of the frames of a rod with inertia, if it was requested."""

    def read(self: Document) -> NDArray[numpy.float64]:
        if "dynamic" not in self.json:
            raise InputError("track: no rod with inertia was asked for (allowed: dynamic=True)")
        return _array(_found(self.json, ["dynamic", "frames", "*", *path.split("/")]))

    return Attribute(read, doc=doc)


class Track(Drawn):
    """A rod while its grippers or obstacles move, frame by frame; result of track(). Arrays of the rod with inertia have
    fewer frames if it stopped earlier."""

    arc_length = _at("arc_length_m", _array, "Arc lengths of the frames' points [m], shape (M,).")
    time = _at("frames/*/time_s", _array, "Times of the frames [s], shape (F,).")
    points = _at("frames/*/points_m", _array, "Positions of the rod at rest [m], shape (F, M, 3).")
    gripper_forces = _at(
        "frames/*/grippers/*/force_N", _array, "Force of each gripper on the rod at rest [N], shape (F, G, 3)."
    )
    gripper_torques = _at(
        "frames/*/grippers/*/torque_Nm", _array, "Torque of each gripper on the rod at rest [N m], shape (F, G, 3)."
    )
    moving_points = _moving("points_m", "Positions of the rod with inertia [m], shape (F, M, 3), with dynamic=True.")
    moving_gripper_forces = _moving("grippers/*/force_N", "Force of each gripper on the rod with inertia [N], shape (F, G, 3).")
    moving_gripper_torques = _moving("grippers/*/torque_Nm", "Torque of each gripper on the rod with inertia [N m], shape (F, G, 3).")


def _deviations(values: Any) -> dict[str, float]:
    return {key: _or_nan(value) for key, value in values.items() if isinstance(value, (float, type(None)))}


class Check(Drawn):
    """A shape compared with its scene's energy model; result of check()."""

    passed = _at("verdict", _passes, "Whether it is within the tolerance, 1 % of the length if none was given.")
    verdict = _at(
        "verdict", str, '"pass", "fail", or "undetermined": within the tolerance, but the points do not determine the rod.'
    )
    significant = _at(
        "significant", lambda value: value, "For a shape that passes: whether the rod without weight and loads would fail. "
        "None if neither acts, or if the shape without them was not found."
    )
    deflection = _at(
        "deflection_m", _or_nan, "Largest distance between the rod with and without weight and loads [m]; "
        "NaN where neither a pass nor the tolerance needs it."
    )
    reason = _at("reason", str, "Reason for the verdict, as text.")
    rms = _at("deviation/rms_m", float, "RMS distance of the points from the rod [m].")
    largest = _at("deviation/max_m", float, "Largest distance of a point [m].")
    energy_above_lowest = _at(
        "state/energy_above_lowest_J", float, "Energy of the equilibrium compared minus the lowest stable one's [J]."
    )
    worst_point = _at("deviation/worst_point", int, "Number of the point with the largest distance, from 1.")
    deviation = _at("deviation", _deviations, "All deviations by name, in the names' units.")
    modulus_ratio = _at("effective_modulus_ratio", _or_nan, "E*/E at which the energy model is nearest; or NaN.")
    explanations = _at("explanations", _causes, "Causes of a failure: (cause, RMS distance that it leaves [m]), best first.")
    arc_length = _at("arc_length_m", _array, "Arc lengths at which the points lie on the rod [m], shape (M,).")
    points = _at("points_m", _array, "Registered points in the order of arc_length [m], shape (M, 3).")
    reference = _at("reference_points_m", _array, "Points of the energy model at arc_length [m], shape (M, 3).")


class Comparison(Drawn):
    """Force model and energy model of a scene; result of compare()."""

    deviation = _at("cases/0/deviation", _deviations, "All deviations by name, in the names' units.")
    modulus_ratio = _at("cases/0/effective_modulus_ratio", _or_nan, "E*/E at which the energy model is nearest; or NaN.")
    arc_length = _at("cases/0/arc_length_m", _array, "Arc lengths of the force model's points [m], shape (N,).")
    force_points = _at("cases/0/force_points_m", _array, "Points of the force model at rest [m], shape (N, 3).")
    energy_points = _at("cases/0/energy_points_m", _array, "Points of the energy model there [m], shape (N, 3).")


@dataclass(repr=False, eq=False)
class Equilibria(Drawn):
    """Every equilibrium that was found: a sequence of Solution, stable ones first, by energy; result of solve_all().
    not_looked: searches for equilibria that were incomplete or not made."""

    _solutions: list[_dlo.Solution]
    not_looked: list[str]

    def __len__(self) -> int:
        return len(self._solutions)

    def __getitem__(self, key: Any) -> Any:
        return self.json[key] if isinstance(key, str) else self._solutions[key]

    def __iter__(self) -> Iterator[_dlo.Solution]:
        return iter(self._solutions)


class MotionCheck(Document):
    """A recorded motion compared with its scene's rod; result of check() with motion."""

    passed = _at("verdict", _passes, "Whether the recording is within the tolerance, 1 % of the length if none was given.")
    reason = _at("reason", str, "Reason for the verdict, in words.")
    rms = _at("rms_m", float, "RMS distance of all points from the rod [m].")
    largest = _at("largest_m", float, "Largest distance of a point [m].")
    time = _at("frames/*/time_s", _array, "Times of the frames [s], shape (F,).")
    errors = _at("frames/*/rms_m", _array, "RMS distance of each frame's points [m], shape (F,).")
    lag = _at("lag_s", _number, "Lag of the recording [s], if it explains much of the distance; else None.")
    causes = _at("causes", _causes, "Candidate causes, best first: (cause, RMS distance that remains with it [m]).")


@dataclass(repr=False, eq=False)
class Regression(Document):
    """Shape errors compared with a baseline; result of regress()."""

    _junit: str
    _update: str = ""

    passed = _at("verdict", _passes, "Whether no case fails; for an update, whether every scene was solved.")

    @property
    def reason(self) -> str:
        """Number of cases with each verdict; for an update that has succeeded, that the baseline is written."""
        written = self._update and self.passed
        return f"{self._update} written" if written else str(self).splitlines()[-1]

    def to_junit(self) -> str:
        """Returns JUnit XML, as `dlo regress --junit` writes it."""
        return self._junit


@dataclass(repr=False, eq=False)
class ScoreCard(Document):
    """Score card of a simulator; result of suite(). json is that of `dlo suite --format json`, with one card."""

    _markdown: str
    _junit: str
    _html: str
    _changes: Optional[str] = None
    _passed: Optional[bool] = None

    card = _at("cards/0", dict, "The card itself: its scenes, classes and total.")
    right = _at("cards/0/total/right", int, "Number of scenes that are right.")
    causes = _at("cards/0/total/causes", dict, "Number of scenes with each cause of an error, by the cause's name.")

    @property
    def passed(self) -> Optional[bool]:
        """Whether no case fails; for an update, whether every scene was solved; None without a baseline."""
        return self._passed

    @property
    def reason(self) -> Optional[str]:
        """Cases that have changed, and the number of cases with each verdict; for an update that has succeeded, that the
        baseline is written; None without a baseline."""
        return self._changes and self._changes.rstrip("\n")

    def to_markdown(self) -> str:
        """Returns the card in Markdown, as `dlo suite --markdown` writes it."""
        return self._markdown

    def to_junit(self) -> str:
        """Returns JUnit XML, as `dlo suite --junit` writes it."""
        return self._junit

    def to_html(self) -> str:
        """Returns a page with a badge, as `dlo suite --report` writes it, but without its picture."""
        return self._html


@dataclass(repr=False, eq=False)
class Calibration(Document):
    """Fitted parameters; result of calibrate()."""

    _toml: str

    def to_toml(self) -> str:
        """Returns the file that `dlo calibrate -o FILE.toml` writes: parameters of the force model; or from measured
        shapes the rod and its fixture ("" if E or a fitted density is not identified and no shapes were predicted, or
        if the rod is given by one of bending_stiffness and mass_per_length alone); or from a recorded motion stiffness
        and damping ("" if the stiffness is not identified)."""
        return self._toml


def _fitted(key: str, doc: str) -> Attribute[Optional[float]]:
    return Attribute(lambda self: _number(self.json.get(key)), doc=doc)


class MaterialFit(Calibration):
    """Young's modulus from measured shapes; result of calibrate()."""

    youngs_modulus = _fitted(
        "youngs_modulus_Pa", "E [Pa]; None if it is not identifiable, or the rod is given by its bending_stiffness."
    )
    bending_stiffness = _fitted(
        "bending_stiffness_Nm2", "EI [N m^2] of a rod given by it; None if it is not identifiable, or E is fitted."
    )

    @property
    def interval(self) -> tuple[Optional[float], Optional[float]]:
        """The 95 % interval of E [Pa], or of EI [N m^2] if the rod is given by it; an end is None where it is open."""
        unit = "_Pa" if "youngs_modulus_Pa" in self.json else "_Nm2"
        low, high = self["interval_95" + unit]
        return low, high


class MotionFit(Calibration):
    """Stiffness and damping from a recorded motion; result of calibrate()."""


class ForceModelFit(Calibration):
    """The force model's parameters; result of calibrate()."""

    parameters = _at("parameters", dict, "Parameters for Scene.force_model and for other programs, in SI units.")
