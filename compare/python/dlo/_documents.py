"""Results that are documents: those of the command, with what one asks for most as attributes."""

from __future__ import annotations

import json
from typing import Any, Optional

import numpy
from numpy.typing import NDArray


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
    """What a scene needs, and bounds of what is left out; of plan()."""


class Stability(Document):
    """Where the steppers break; of stability()."""


class Benchmark(Document):
    """What accuracy costs; of bench()."""


class Modes(Document):
    """The slowest modes of a scene's rod; of modes()."""

    @property
    def frequencies(self) -> NDArray[numpy.float64]:
        """Of the rod [Hz], shape (n,); NaN where it falls instead of swinging."""
        return numpy.array([mode["frequency_Hz"] for mode in self["modes"]], dtype=float)

    @property
    def arc_length(self) -> NDArray[numpy.float64]:
        """Where the modes' shapes are given [m], shape (M,)."""
        return numpy.array(self["arc_length_m"], dtype=float)

    @property
    def shapes(self) -> NDArray[numpy.float64]:
        """The modes' displacements, shape (n, M, 3)."""
        return numpy.array([mode["shape_m"] for mode in self["modes"]], dtype=float)


class Calibration(Document):
    """Parameters that were fitted; of calibrate()."""

    def __init__(self, text: str, json_text: str, toml: str) -> None:
        super().__init__(text, json_text)
        self._toml = toml

    def to_toml(self) -> str:
        """What `dlo calibrate -o FILE.toml` writes: a file of parameters (of the force model) or of
        materials (of measured shapes; "" if E is not told)."""
        return self._toml


class MaterialFit(Calibration):
    """Young's modulus from measured shapes; of calibrate()."""

    @property
    def youngs_modulus(self) -> Optional[float]:
        """E [Pa], of a rod that is given by its EI that [N m^2]; None if the shapes do not tell it."""
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
