"""Pictures with matplotlib, which is imported only here."""

from __future__ import annotations

import io
from typing import Any, Optional

import numpy

from . import _dlo

_NAMES = "xyz"


def _lines(result: Any) -> list[tuple[Any, dict[str, Any]]]:
    """Points, each with how it is drawn."""
    if isinstance(result, _dlo.Solution):
        return [(result.points, {"label": result.model})]
    if isinstance(result, _dlo.Equilibria):
        return [
            (
                state.points,
                {
                    "linestyle": "-" if state.stable else "--",
                    "label": f"{number + 1}: {state.energy['total']:.4g} J",
                },
            )
            for number, state in enumerate(result)
        ]
    if isinstance(result, _dlo.Check):
        whiskers = [
            (numpy.array(pair), {"color": "0.6", "linewidth": 0.8, "zorder": 0})
            for pair in zip(result.points, result.reference)
        ]
        return [
            (result.reference, {"label": "energy"}),
            (result.points, {"linestyle": "none", "marker": ".", "label": "points"}),
            *whiskers,
        ]
    if isinstance(result, _dlo.Comparison):
        return [
            (result.energy_points, {"label": "energy"}),
            (result.force_points, {"marker": ".", "label": "force"}),
        ]
    return _frames(result.time, result.points)


def _frames(time: Any, points: Any) -> list[tuple[Any, dict[str, Any]]]:
    """Some of many, the later the darker."""
    shown = numpy.unique(numpy.linspace(0, len(time) - 1, 9).round().astype(int))
    return [
        (
            points[frame],
            {
                "color": str(0.8 * (1 - place / max(1, len(shown) - 1))),
                "label": f"{time[frame]:.4g} s" if place in (0, len(shown) - 1) else None,
            },
        )
        for place, frame in enumerate(shown)
    ]


def _fill(ax: Any, result: Any) -> None:
    views = result._views
    axes = (0, 1, 2) if ax.name == "3d" else views[0]
    for points, style in _lines(result):
        ax.plot(*points.T[list(axes)], **style)
    flattest = 0.3  # of the longest side: what is flatter has no room for the numbers at its axis
    names = _NAMES[: len(axes)]
    limits = {name: getattr(ax, f"get_{name}lim")() for name in names}
    least = flattest * max(high - low for low, high in limits.values())
    for axis, (name, (low, high)) in zip(axes, limits.items()):
        half, middle = max(high - low, least) / 2, (low + high) / 2
        getattr(ax, f"set_{name}lim")(middle - half, middle + half)
        getattr(ax, f"set_{name}label")(f"{_NAMES[axis]} [m]")
    ax.set_aspect("equal")
    # Above the axes: whatever their shape, nothing is drawn there.
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, frameon=False)


def plot(result: Any, ax: Any = None) -> Any:
    """Draws what has a shape at equal aspect: in the plane that it lies in, else in space."""
    if ax is None:
        import matplotlib.pyplot

        ax = _new_axes(matplotlib.pyplot.figure(layout="constrained"), result)
    _fill(ax, result)
    return ax


def _new_axes(figure: Any, result: Any) -> Any:
    return figure.add_subplot(projection="3d" if len(result._views) > 1 else None)


def svg(result: Any) -> Optional[str]:
    """The same as a file's text; None without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure()
    _fill(_new_axes(figure, result), result)
    file = io.StringIO()
    figure.savefig(file, format="svg", bbox_inches="tight")
    return file.getvalue()
