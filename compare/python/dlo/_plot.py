"""Pictures with matplotlib, which is imported only here."""

from __future__ import annotations

from typing import Any

import numpy

from . import _dlo


def _axes(ax: Any, spatial: bool) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot

    figure = matplotlib.pyplot.figure()
    return figure.add_subplot(projection="3d" if spatial else None)


def _lines(result: Any) -> list[tuple[Any, dict[str, Any]]]:
    """Points, each with how it is drawn."""
    if isinstance(result, _dlo.Solution):
        return [(result.points, {"label": result.model})]
    if isinstance(result, _dlo.Equilibria):
        lines = []
        for number, state in enumerate(result):
            style = "-" if state.stable else "--"
            label = f"{number + 1}: {state.energy['total']:.4g} J"
            lines.append((state.points, {"linestyle": style, "label": label}))
        return lines
    if isinstance(result, _dlo.Check):
        return [
            (result.reference, {"label": "energy"}),
            (result.points, {"linestyle": "none", "marker": ".", "label": "points"}),
        ]
    return [
        (result.energy_points, {"label": "energy"}),
        (result.force_points, {"marker": ".", "label": "force"}),
    ]


def plot(result: Any, ax: Any = None) -> Any:
    """Draws what has a shape at equal aspect: in the plane x-y if it lies there, else in space."""
    lines = _lines(result)
    extent = max(float(numpy.ptp(points, axis=0).max()) for points, _ in lines)
    spatial = any(float(numpy.abs(points[:, 2]).max()) > 1e-9 * extent for points, _ in lines)
    ax = _axes(ax, spatial)
    in_space = ax.name == "3d"
    for points, style in lines:
        ax.plot(*(points.T if in_space else points[:, :2].T), **style)
    if isinstance(result, _dlo.Check) and not in_space:
        for point, rod in zip(result.points, result.reference):
            ax.plot([point[0], rod[0]], [point[1], rod[1]], color="0.6", linewidth=0.8, zorder=0)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    if in_space:
        ax.set_zlabel("z [m]")
    ax.set_aspect("equal")
    ax.legend()
    return ax
