"""Representations of results, in the words of the library."""

from __future__ import annotations

import html as _html
from typing import Any, Optional

from . import _plot


def words(result: Any) -> str:
    """Returns one line: the verdict and its reason, else the RMS deviation, else the beginning of the text."""
    passed = getattr(result, "passed", None)
    if passed is not None:
        verdict = getattr(result, "verdict", "pass" if passed else "fail")
        return f"{verdict}: {', '.join(result.reason.splitlines())}"
    deviation = getattr(result, "deviation", None)
    if deviation is not None:
        return f"RMS {1e3 * deviation['rms_m']:.4g} mm"
    lines = [" ".join(text.split()) for text in str(result).splitlines() if text.strip()]
    # If the first line names the scene, the next one states the kind of result.
    return ", ".join(lines[: 2 if lines[0].startswith("scene ") else 1])


def line(result: Any) -> str:
    """Returns the text of __repr__."""
    return f"<dlo.{type(result).__name__} {words(result)}>"


def svg(result: Any) -> Optional[str]:
    """Returns the picture of a result as SVG; None if the result has none, or without matplotlib."""
    return _plot.svg(result) if hasattr(result, "_panel") else None


def html(result: Any) -> str:
    """Returns the line of words(), the picture, if there is one, and the text as HTML."""
    picture = svg(result) or ""
    return (
        f"<div><p><b>{_html.escape(words(result))}</b></p>{picture[picture.find('<svg'):]}"
        f"<pre>{_html.escape(str(result))}</pre></div>"
    )
