"""Results that are documents: those of the command, with what one asks for most as attributes."""

from __future__ import annotations

import json
from typing import Any, Optional

import numpy
from numpy.typing import NDArray

from . import _plot, _show
from ._errors import InputError


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

    @property
    def frequencies(self) -> NDArray[numpy.float64]:
        """Of the rod [Hz], shape (n,); NaN where the shape is unstable."""
        return numpy.array([mode["frequency_Hz"] for mode in self["modes"]], dtype=float)

    @property
    def arc_length(self) -> NDArray[numpy.float64]:
        """Where the modes' shapes are given [m], shape (M,)."""
        return numpy.array(self["arc_length_m"], dtype=float)

    @property
    def shapes(self) -> NDArray[numpy.float64]:
        """The modes' displacements, shape (n, M, 3)."""
        return numpy.array([mode["shape_m"] for mode in self["modes"]], dtype=float)


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

    @property
    def arc_length(self) -> NDArray[numpy.float64]:
        """Of the frames' points [m], shape (M,)."""
        return numpy.array(self["arc_length_m"], dtype=float)

    @property
    def time(self) -> NDArray[numpy.float64]:
        """Of the frames [s], shape (F,)."""
        return self._frames("time_s")

    @property
    def points(self) -> NDArray[numpy.float64]:
        """At rest [m], shape (F, M, 3)."""
        return self._frames("points_m")

    @property
    def gripper_forces(self) -> NDArray[numpy.float64]:
        """What each gripper exerts on the rod at rest [N], shape (F, G, 3)."""
        return self._grippers("force_N")

    @property
    def gripper_torques(self) -> NDArray[numpy.float64]:
        """The same about each gripper's position [N m], shape (F, G, 3)."""
        return self._grippers("torque_Nm")

    @property
    def moving_points(self) -> NDArray[numpy.float64]:
        """Of the rod with inertia [m], shape (F, M, 3); of one that was asked for (dynamic)."""
        return self._frames("points_m", moving=True)

    @property
    def moving_gripper_forces(self) -> NDArray[numpy.float64]:
        """The same of the grippers' forces [N], shape (F, G, 3)."""
        return self._grippers("force_N", moving=True)

    @property
    def moving_gripper_torques(self) -> NDArray[numpy.float64]:
        """The same of their torques [N m], shape (F, G, 3)."""
        return self._grippers("torque_Nm", moving=True)

    def _list(self, moving: bool) -> list[dict[str, Any]]:
        if moving and "dynamic" not in self.json:
            raise InputError("track: no rod with inertia was asked for (allowed: dynamic=True)")
        frames: list[dict[str, Any]] = (self["dynamic"] if moving else self.json)["frames"]
        return frames

    def _frames(self, key: str, moving: bool = False) -> NDArray[numpy.float64]:
        return numpy.array([frame[key] for frame in self._list(moving)], dtype=float)

    def _grippers(self, key: str, moving: bool = False) -> NDArray[numpy.float64]:
        frames = self._list(moving)
        return numpy.array(
            [[gripper[key] for gripper in frame["grippers"]] for frame in frames], dtype=float
        )


class MotionCheck(Document):
    """A recorded motion against its scene's rod; of check() with motion."""

    @property
    def passed(self) -> bool:
        """Whether it is within the tolerance, 1 % of the length if none was given."""
        return bool(self["verdict"] == "pass")

    @property
    def reason(self) -> str:
        """Why, in words."""
        return str(self["reason"])

    @property
    def rms(self) -> float:
        """RMS distance of all points from the rod [m]."""
        return float(self["rms_m"])

    @property
    def largest(self) -> float:
        """Largest distance of a point [m]."""
        return float(self["largest_m"])

    @property
    def time(self) -> NDArray[numpy.float64]:
        """Of the frames [s], shape (F,)."""
        return numpy.array([frame["time_s"] for frame in self["frames"]], dtype=float)

    @property
    def errors(self) -> NDArray[numpy.float64]:
        """RMS distance of each frame's points [m], shape (F,)."""
        return numpy.array([frame["rms_m"] for frame in self["frames"]], dtype=float)

    @property
    def lag(self) -> Optional[float]:
        """By which the recording is late [s], where that explains much of the distance; else None."""
        lag: Optional[float] = self["lag_s"]
        return lag

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

    @property
    def passed(self) -> bool:
        """Whether no case fails; of an update, whether every scene was solved."""
        return bool(self["verdict"] == "pass")

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


class MaterialFit(Calibration):
    """Young's modulus from measured shapes; of calibrate()."""

    def _number(self, key: str) -> Optional[float]:
        value = self.json.get(key)
        return None if value is None else float(value)

    @property
    def youngs_modulus(self) -> Optional[float]:
        """E [Pa]; None if it is not identifiable, or the rod is given by its bending_stiffness."""
        return self._number("youngs_modulus_Pa")

    @property
    def bending_stiffness(self) -> Optional[float]:
        """EI [N m^2] of a rod that is given by it; None if it is not identifiable, or E is fitted."""
        return self._number("bending_stiffness_Nm2")

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
