"""Tests of the representations of results, and of their pictures."""

import builtins
import xml.etree.ElementTree

import numpy
import pytest

import dlo

matplotlib = pytest.importorskip("matplotlib")
import matplotlib.pyplot as pyplot  # noqa: E402


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


def hung(**fields):
    """Returns a soft rod that hangs from a clamp, with some fields changed."""
    scene = {
        "length": "1 m",
        "diameter": "8 mm",
        "material": {"youngs_modulus": "60 MPa", "density": 1150},
        "grippers": [dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
    }
    return dlo.Scene(**{**scene, **fields})


LEVEL = dlo.clamp(at=0, position=(0.3, 0, 0), direction=(0, 1, 0))
STEEP = dlo.clamp(at=0, position=(0, 0, 0), direction=(0, -1, 0.1))
SCENES = {
    "flat": lambda: hung(material="spring_steel"),
    "tall": lambda: hung(grippers=[STEEP], gravity=(0, -9.81, 0)),
    "upright": lambda: hung(gravity=(0, 0, -9.81)),  # in the plane x-z
    "sideways": lambda: hung(grippers=[LEVEL], gravity=(0, 0, -9.81)),  # in the plane y-z
    "spatial": lambda: hung(loads=[dlo.load(at="1 m", force=(0, 0, "50 mN"))]),
}


def shapes(name):
    """Returns four results of one scene that have pictures: a solution, all solutions, a check and a comparison."""
    scene = SCENES[name]()
    scene.force_model = {"points": 12}
    solution = dlo.solve(scene, samples=41)
    return [
        solution,
        dlo.solve_all(scene, samples=41),
        dlo.check(scene, solution.points[::4] + 0.005, tolerance="1%", explain=False, modulus=False),
        dlo.compare(scene, modulus=False),
    ]


@pytest.mark.parametrize(
    "name, axes", [("flat", "xy"), ("upright", "xz"), ("sideways", "yz"), ("spatial", "xyz")]
)
def test_a_scene_is_drawn_in_its_plane(name, axes):
    for result in shapes(name)[::3]:
        ax = result.plot()
        labels = [getattr(ax, f"get_{own}label")() for own in "xyz"[: len(axes)]]
        assert labels == [f"{axis} [m]" for axis in axes]
        assert (ax.name == "3d") == (len(axes) == 3)
        if len(axes) == 2:
            columns = ["xyz".index(axis) for axis in axes]
            points = getattr(result, "points", None)
            points = result.force_points if points is None else points
            drawn = [line.get_xydata() for line in ax.lines]
            assert any(numpy.array_equal(line, points[:, columns]) for line in drawn)
            assert ax.get_aspect() == 1


@pytest.mark.parametrize("name", [*SCENES, "twisted", "moving"])
def test_no_legend_lies_on_a_plot(name, root, tmp_path):
    if name == "moving":
        results = [dlo.track(root / "data/scenes/swung_rod.toml", frame_rate=25, end=0.6, force=False)]
    elif name == "twisted":
        results = [dlo.solve(dlo.Scene.from_file(root / "data/scenes/twisted_wire.toml"), samples=41)]
    else:
        results = shapes(name)
    for number, result in enumerate(results):
        ax = result.plot()
        figure = ax.figure
        figure.savefig(tmp_path / f"{number}.png")
        renderer = figure.canvas.get_renderer()
        legend = ax.get_legend().get_window_extent(renderer)
        plot = ax.get_window_extent(renderer)
        assert legend.y1 <= plot.y0 + 1
        label = ax.xaxis.get_label().get_window_extent(renderer)
        assert not legend.overlaps(label) or ax.name == "3d"
        for line in ax.lines if ax.name != "3d" else []:
            drawn = ax.transData.transform(line.get_xydata())
            assert not numpy.any(legend.count_contains(drawn))
        # All of it is in the picture, and what is flat has room for its numbers.
        assert legend.y0 >= -1 and figure.bbox.x1 >= legend.x1 >= legend.x0 >= 0
        assert plot.height > 60 and plot.width > 60


def test_a_picture_is_the_librarys():
    """Titles, limits and points equal those of the library's description, from which gnuplot also draws."""
    result = dlo.solve(SCENES["tall"](), samples=41)
    panel = result._panel(None)
    ax = result.plot()
    titles = [text.get_text() for text in ax.get_legend().get_texts()]
    assert titles == [curve["title"] for curve in panel["curves"] if curve["title"]] and "gripper" in titles
    assert (ax.get_xlim(), ax.get_ylim()) == tuple(axis["limits"] for axis in panel["axes"])
    assert len(ax.lines) == len(panel["curves"])
    for line, curve in zip(ax.lines, panel["curves"]):
        numpy.testing.assert_array_equal(line.get_xydata().T, curve["points"])
        assert line.get_color() == curve["colour"]


def test_results_show_themselves(cable, root):
    cable.force_model = {"points": 12}
    check = dlo.check(cable, dlo.solve(cable, samples=41).points, tolerance="1%")
    assert repr(check) == f"<dlo.Check pass: {check.reason}>"
    moved = root / "data/scenes/swung_rod.toml"
    results = [
        *shapes("upright"),
        check,
        dlo.track(moved, frame_rate=25, end=0.2, force=False, samples=9),
    ]
    for result in results:
        line = repr(result)
        assert line.startswith(f"<dlo.{type(result).__name__} ") and "\n" not in line and len(line) < 200
        drawn = xml.etree.ElementTree.fromstring(result._repr_svg_())
        assert drawn.tag.endswith("svg")
        page = result._repr_html_()
        assert page.count("<svg") == page.count("</svg>") == 1 and "<?xml" not in page
        assert check.reason in page or result is not check
    for result in (dlo.plan(cable), dlo.modes(cable, count=1, samples=5)):
        assert "\n" not in repr(result) and repr(result).startswith(f"<dlo.{type(result).__name__} ")
        assert "<svg" not in result._repr_html_() and "<pre>" in result._repr_html_()


def test_without_matplotlib_the_words_are_left(cable, monkeypatch):
    solution = dlo.solve(cable, samples=9)
    real = builtins.__import__

    def without(name, *arguments, **named):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    assert solution._repr_svg_() is None
    assert "<pre>" in solution._repr_html_() and "<svg" not in solution._repr_html_()
