"""Results that are documents of the command, with frequently used values as attributes."""

from __future__ import annotations

import json
from typing import Any, Callable, Optional

import numpy
from numpy.typing import NDArray

from . import _plot, _show
from ._arguments import Attribute, Value
from ._errors import InputError

__all__ = [
    "Benchmark", "Document", "ForceModelFit", "MaterialFit", "Modes", "MotionCheck", "MotionFit", "Plan", "Regression",
    "ScoreCard", "Stability", "Track",
]


def _found(value: Any, path: list[str]) -> Any:
    """Returns the value at a path of keys; for the key *, the list of the values in each element."""
    for i, key in enumerate(path):
        if key == "*":
            return [_found(one, path[i + 1 :]) for one in value]
        value = value[key]
    return value


def _at(path: str, kind: Callable[[Any], Value], doc: str) -> Attribute[Value]:
    """Returns an attribute that reads a document at a path, such as "frames/*/time_s"."""
    return Attribute(lambda self: kind(_found(self.json, path.split("/"))), doc=doc)


def _array(values: Any) -> NDArray[numpy.float64]:
    return numpy.array(values, dtype=float)


def _passes(verdict: Any) -> bool:
    return bool(verdict == "pass")


def _number(value: Any) -> Optional[float]:
    return None if value is None else float(value)


class Document:
    """A result as the command writes it: str() is its text, json its JSON as a dict."""

    def __init__(self, text: str, json_text: str) -> None:
        self._text = text
        self._json_text = json_text
        self._json: Optional[dict[str, Any]] = None

    @property
    def json(self) -> dict[str, Any]:
        """The command's document, as a dict."""
        if self._json is None:
            self._json = json.loads(self._json_text)
        return self._json

    def to_json(self) -> str:
        """The command's document, as text."""
        return self._json_text

    def __getitem__(self, key: str) -> Any:
        return self.json[key]

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return _show.line(self)

    def _repr_html_(self) -> str:
        return _show.html(self)


class Plan(Document):
    """What a scene needs, and bounds of what is neglected; of plan()."""


class Stability(Document):
    """Where the steppers break; of stability()."""


class Benchmark(Document):
    """What accuracy costs; of bench()."""


class Modes(Document):
    """The slowest modes of a scene's rod; of modes()."""

    frequencies = _at("modes/*/frequency_Hz", _array, "Of the rod [Hz], shape (n,); NaN where the shape is unstable.")
    arc_length = _at("arc_length_m", _array, "Where the modes' shapes are given [m], shape (M,).")
    shapes = _at("modes/*/shape_m", _array, "The modes' displacements, shape (n, M, 3).")


def _moving(path: str, doc: str) -> Attribute[NDArray[numpy.float64]]:
    """Returns an attribute of the frames of a rod with inertia, if it was requested."""

    def read(self: Document) -> NDArray[numpy.float64]:
        if "dynamic" not in self.json:
            raise InputError("track: no rod with inertia was asked for (allowed: dynamic=True)")
        return _array(_found(self.json, ["dynamic", "frames", "*", *path.split("/")]))

    return Attribute(read, doc=doc)


class Track(Document):
    """A rod while its grippers move, frame by frame; of track()."""

    _strip: dict[str, Any]

    def _panel(self, in_space: Optional[bool]) -> dict[str, Any]:
        return self._strip

    def plot(self, ax: Any = None) -> Any:
        """Draws nine of the frames with matplotlib, row by row, at equal aspect. ax: the axes to
        draw into, new ones for None; returned."""
        return _plot.plot(self, ax)

    def _repr_svg_(self) -> Optional[str]:
        return _show.svg(self)

    arc_length = _at("arc_length_m", _array, "Of the frames' points [m], shape (M,).")
    time = _at("frames/*/time_s", _array, "Of the frames [s], shape (F,).")
    points = _at("frames/*/points_m", _array, "At rest [m], shape (F, M, 3).")
    gripper_forces = _at(
        "frames/*/grippers/*/force_N", _array, "What each gripper exerts on the rod at rest [N], shape (F, G, 3)."
    )
    gripper_torques = _at(
        "frames/*/grippers/*/torque_Nm", _array, "The same about each gripper's position [N m], shape (F, G, 3)."
    )
    moving_points = _moving("points_m", "Of the rod with inertia [m], shape (F, M, 3); of one that was asked for (dynamic).")
    moving_gripper_forces = _moving("grippers/*/force_N", "The same of the grippers' forces [N], shape (F, G, 3).")
    moving_gripper_torques = _moving("grippers/*/torque_Nm", "The same of their torques [N m], shape (F, G, 3).")


class MotionCheck(Document):
    """A recorded motion against its scene's rod; of check() with motion."""

    passed = _at("verdict", _passes, "Whether it is within the tolerance, 1 % of the length if none was given.")
    reason = _at("reason", str, "Why, in words.")
    rms = _at("rms_m", float, "RMS distance of all points from the rod [m].")
    largest = _at("largest_m", float, "Largest distance of a point [m].")
    time = _at("frames/*/time_s", _array, "Of the frames [s], shape (F,).")
    errors = _at("frames/*/rms_m", _array, "RMS distance of each frame's points [m], shape (F,).")
    lag = _at("lag_s", _number, "By which the recording is late [s], where that explains much of the distance; else None.")

    @property
    def causes(self) -> list[tuple[str, float]]:
        """What would bring it nearer: (cause, RMS distance were it so [m]), the best first."""
        return [(cause["cause"], cause["rms_m"]) for cause in self["causes"]]


class Regression(Document):
    """Shape errors against a baseline; of regress()."""

    def __init__(self, text: str, json_text: str, junit: str, update: str = "") -> None:
        super().__init__(text, json_text)
        self._junit = junit
        self._update = update

    passed = _at("verdict", _passes, "Whether no case fails; of an update, whether every scene was solved.")

    @property
    def reason(self) -> str:
        """How many cases have become what; of an update that the baseline is written."""
        written = self._update and self.passed
        return f"{self._update} written" if written else self._text.splitlines()[-1]

    def to_junit(self) -> str:
        """What `dlo regress --junit` writes: JUnit XML."""
        return self._junit


class ScoreCard(Document):
    """A simulator on the battery; of suite(). json is the document of `dlo suite --format json`, with one card."""

    def __init__(
        self,
        text: str,
        json_text: str,
        markdown: str,
        junit: str,
        html: str,
        changes: Optional[str] = None,
        passed: Optional[bool] = None,
    ) -> None:
        super().__init__(text, json_text)
        self._markdown = markdown
        self._junit = junit
        self._html = html
        self._changes = changes
        self._passed = passed

    @property
    def passed(self) -> Optional[bool]:
        """Whether no error is worse than the baseline's; of an update, whether all was solved; None without one."""
        return self._passed

    @property
    def reason(self) -> Optional[str]:
        """The cases that have changed, and how many have become what; None without a baseline."""
        return None if self._changes is None else self._changes.rstrip("\n")

    @property
    def card(self) -> dict[str, Any]:
        """The card itself: its scenes, classes and total."""
        card: dict[str, Any] = self["cards"][0]
        return card

    @property
    def right(self) -> int:
        """Scenes that are right."""
        return int(self.card["total"]["right"])

    @property
    def causes(self) -> dict[str, int]:
        """What is wrong, by name, and in how many scenes."""
        return dict(self.card["total"]["causes"])

    def to_markdown(self) -> str:
        """What `dlo suite --markdown` writes."""
        return self._markdown

    def to_junit(self) -> str:
        """What `dlo suite --junit` writes: JUnit XML."""
        return self._junit

    def to_html(self) -> str:
        """What `dlo suite --report` writes, without its picture: a page with a badge."""
        return self._html


class Calibration(Document):
    """Parameters that were fitted; of calibrate()."""

    def __init__(self, text: str, json_text: str, toml: str) -> None:
        super().__init__(text, json_text)
        self._toml = toml

    def to_toml(self) -> str:
        """What `dlo calibrate -o FILE.toml` writes: a file of parameters (of the force model) or of
        materials (of measured shapes; "" where E is not identified and no shapes were predicted), or
        stiffness and damping (of a recorded motion; "" where the stiffness is not identified)."""
        return self._toml


def _fitted(key: str, doc: str) -> Attribute[Optional[float]]:
    return Attribute(lambda self: _number(self.json.get(key)), doc=doc)


class MaterialFit(Calibration):
    """Young's modulus from measured shapes; of calibrate()."""

    youngs_modulus = _fitted(
        "youngs_modulus_Pa", "E [Pa]; None if it is not identifiable, or the rod is given by its bending_stiffness."
    )
    bending_stiffness = _fitted(
        "bending_stiffness_Nm2", "EI [N m^2] of a rod that is given by it; None if it is not identifiable, or E is fitted."
    )

    @property
    def interval(self) -> tuple[Optional[float], Optional[float]]:
        """The 95 % interval of what is fitted; an end is None where it is open."""
        unit = "_Pa" if "youngs_modulus_Pa" in self.json else "_Nm2"
        low, high = self["interval_95" + unit]
        return low, high


class MotionFit(Calibration):
    """Stiffness and damping from a recorded motion; of calibrate()."""


class ForceModelFit(Calibration):
    """The force model's parameters; of calibrate()."""

    @property
    def parameters(self) -> dict[str, Any]:
        """For Scene.force_model and for programs of your own, in SI units."""
        return dict(self["parameters"])
