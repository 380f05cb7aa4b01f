"""Results that are documents: those of the command, with what one asks for most as attributes."""

from __future__ import annotations

import json
from typing import Any, Optional

import numpy
from numpy.typing import NDArray

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


class Calibration(Document):
    """Parameters that were fitted; of calibrate()."""

    def __init__(self, text: str, json_text: str, toml: str) -> None:
        super().__init__(text, json_text)
        self._toml = toml

    def to_toml(self) -> str:
        """What `dlo calibrate -o FILE.toml` writes: a file of parameters (of the force model) or of
        materials (of measured shapes; "" if E is not identified)."""
        return self._toml


class MaterialFit(Calibration):
    """Young's modulus from measured shapes; of calibrate()."""

    @property
    def youngs_modulus(self) -> Optional[float]:
        """E [Pa], of a rod that is given by its EI that [N m^2]; None if it is not identifiable."""
        value = self.json.get("youngs_modulus_Pa", self.json.get("bending_stiffness_Nm2"))
        return None if value is None else float(value)

    @property
    def interval(self) -> tuple[Optional[float], Optional[float]]:
        """Its 95 % interval; an end is None where it is open."""
        unit = "_Pa" if "youngs_modulus_Pa" in self.json else "_Nm2"
        low, high = self["interval_95" + unit]
        return low, high


class ForceModelFit(Calibration):
    """The force model's parameters; of calibrate()."""

    @property
    def parameters(self) -> dict[str, Any]:
        """For Scene.force_model and for programs of your own, in SI units."""
        return dict(self["parameters"])
