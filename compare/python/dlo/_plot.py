"""Pictures with matplotlib, which is imported only here. The library determines their content and style."""

from __future__ import annotations

import io
from typing import Any, Optional

from ._errors import InputError

# In the order of the library's Dashes and Mark.
_DASHES = ("-", "--", ":", "-.", (0, (6, 2, 1, 2, 1, 2)))
_MARKS = ("", "x", "s", "s", "o", "o", "^", "v", "D")
_FULL = (1, 3, 5)


def _draw_curve(ax: Any, curve: dict[str, Any]) -> None:
    label = curve["title"] or None
    if curve["fill"]:
        ax.fill(*curve["points"], facecolor=curve["fill"], edgecolor=curve["colour"], label=label, zorder=2)
        return
    ax.plot(
        *curve["points"],
        color=curve["colour"],
        linewidth=0.8 * curve["width"],
        linestyle=_DASHES[curve["dashes"]] if curve["width"] else "none",
        marker=_MARKS[curve["mark"]] or None,
        markersize=6 * curve["mark_size"],
        markerfacecolor=curve["colour"] if curve["mark"] in _FULL else "none",
        label=label,
    )


def _draw(ax: Any, panel: dict[str, Any]) -> None:
    for curve in panel["curves"]:
        _draw_curve(ax, curve)
    for words, x, y, right, up in panel["texts"]:
        ax.annotate(words, (x, y), (0.9 * right, 0.9 * up), textcoords="offset points", va="center", fontsize="small")
    label_pad = 9 if ax.name == "3d" else None  # otherwise the label overlaps the numbers
    for name, axis in zip("xyz", panel["axes"]):
        getattr(ax, f"set_{name}lim")(*axis["limits"])
        getattr(ax, f"set_{name}label")(axis["label"], labelpad=label_pad)
        if axis["log"]:
            getattr(ax, f"set_{name}scale")("log")
        if axis["tics"] is not None:
            getattr(ax, f"set_{name}ticks")([at for at, _ in axis["tics"]], [label for _, label in axis["tics"]])
    if ax.name == "3d":
        # The box is smaller than the area of the plot, to leave space for the names of the axes.
        ax.set_box_aspect([high - low for low, high in (axis["limits"] for axis in panel["axes"])], zoom=0.8)
        ax.locator_params(nbins=5)
    elif panel["equal"]:
        ax.set_aspect("equal")
    ax.grid(True, color="0.9")
    if any(curve["title"] for curve in panel["curves"]):
        # Below the numbers and the name of the axis. In space these are inside the area, so that it is free there.
        ax.legend(
            loc="upper left", bbox_to_anchor=(0, 0), borderaxespad=1 if ax.name == "3d" else 4, frameon=False
        )


def plot(result: Any, ax: Any = None) -> Any:
    """Draws a result with a shape at equal aspect and returns the axes. ax: the axes to draw into, in the plane or in
    space; None: new ones, in the plane of the result if it has one, else in space."""
    if ax is not None and not hasattr(ax, "get_figure"):
        allowed = 'axes of matplotlib, or None; plot().figure.savefig("FILE.svg") writes a file'
        raise InputError(f"ax = {ax!r}: a {type(ax).__name__} (allowed: {allowed})")
    panel = result._panel(None if ax is None else ax.name == "3d")
    if ax is None:
        import matplotlib.pyplot

        ax = _new_axes(matplotlib.pyplot.figure, panel)
    _draw(ax, panel)
    return ax


def _new_axes(figure: Any, panel: dict[str, Any]) -> Any:
    pixels = 80  # pixels of the library per inch, so that letters have the size of its pictures
    width, height = panel["size"]
    made = figure(figsize=(width / pixels, height / pixels), layout="constrained")
    made.get_layout_engine().set(h_pad=0.2)  # the default margin is too small for a plot in space [inches]
    if len(panel["axes"]) == 2:
        return made.add_subplot()
    ax = made.add_subplot(projection="3d")
    # x points to the right, or y if x is vertical.
    ax.view_init(azim=(-60, 30, -60)[panel["upright"]], vertical_axis="xyz"[panel["upright"]])
    return ax


def svg(result: Any) -> Optional[str]:
    """Returns the picture as the text of an SVG file; None without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return None
    panel = result._panel(None)
    ax = _new_axes(Figure, panel)
    _draw(ax, panel)
    file = io.StringIO()
    ax.figure.savefig(file, format="svg", bbox_inches="tight")
    return file.getvalue()
