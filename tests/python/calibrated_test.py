"""Tests of calibrated rods in place of the scenes' own: Python and the command give the same digits."""

import subprocess

import numpy
import pytest
from conftest import refuses, without_times

import dlo

FOUND = """bending_stiffness = 2e-3
mass_per_length = 0.02
natural_curvature = [[0, 0.6], [0, -0.4]]
camera_tilt = [0, 0, "2 deg"]
[[gripper]]
number = 2
rotation = [0, 0, "-7 deg"]
displacement = ["3 mm", 0, 0]
"""

MATERIAL = '[[material]]\nname = "calibrated"\nyoungs_modulus = 4e9\ndensity = 2000\n'


@pytest.fixture
def wire(root):
    return root / "data/mountings/wire.toml"


@pytest.fixture
def found(tmp_path):
    (tmp_path / "found.toml").write_text(FOUND)
    return tmp_path / "found.toml"


def test_a_calibrated_wire_is_the_commands(wire, found, root, command_json):
    options = (wire, "--calibrated", found)
    solution = dlo.solve(wire, calibrated=found, samples=7)
    assert without_times(solution.json) == command_json("solve", *options, "--samples", 7)
    shape = root / "data/mountings/mounting_6.csv"
    check = dlo.check(dlo.Scene.from_file(wire), shape, calibrated=str(found), explain=False)
    assert {**check.json, "scene": ""} == {
        **command_json("check", *options, "--shape", shape, "--no-explanation"), "scene": ""}


def test_a_calibrated_rod_that_moves_is_the_commands(root, tmp_path, command_json):
    swung = root / "data/scenes/swung_rod.toml"
    found = tmp_path / "found.toml"
    found.write_text(MATERIAL + "[[gripper]]\nnumber = 1\nrotation = [0, 0, 0.1]\n")
    track = dlo.track(swung, end=0.05, frame_rate=50, force=False, samples=5, calibrated=found)
    options = "--to 0.05 --frame-rate 50 --no-force --samples 5 --shapes --calibrated".split()
    assert without_times(track.json) == command_json("track", swung, *options, found)


def test_what_calibrate_returns_is_what_its_file_says(cable, tmp_path):
    guess = cable.replace(material={"youngs_modulus": "1 MPa", "density": 1150})
    truth = dlo.solve(cable, model="exact", samples=15)
    fit = dlo.calibrate(guess, [(truth.points, truth.arc_length)])
    assert fit.youngs_modulus == pytest.approx(5e6, rel=1e-6)
    assert fit.interval[0] <= 5e6 <= fit.interval[1]
    (tmp_path / "fit.toml").write_text(fit.to_toml())
    found = dlo.solve(guess, model="exact", samples=15, calibrated=fit)
    numpy.testing.assert_array_equal(
        found.points, dlo.solve(guess, model="exact", samples=15, calibrated=tmp_path / "fit.toml").points)
    # E to 1e-6 of itself moves no point by more than that share of the length.
    numpy.testing.assert_allclose(found.points, truth.points, atol=1e-6)
    assert guess.youngs_modulus == 1e6  # the scene itself is as it was


@pytest.fixture
def stiff():
    """Returns a scene with w l^3 / (EI) = 0.5, and three noisy shapes of it with arc lengths."""
    scene = dlo.Scene(length=1, bending_stiffness=1.962, mass_per_length=0.1,
                      grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="20 deg")])
    rod = dlo.solve(scene, samples=30)
    random = numpy.random.default_rng(3)
    errors = numpy.zeros((3, *rod.points.shape))
    errors[:, :, :2] = random.normal(0, 1e-4, (3, rod.points.shape[0], 2))
    return scene, [(rod.points + error, rod.arc_length) for error in errors]


def test_a_fit_that_predicts_shapes_has_a_file_though_it_is_no_material(stiff):
    """Natural curvature explains the shapes of a stiff rod as well as its weight does, so EI is not identified."""
    scene, shapes = stiff
    options = dict(natural_curvature=3, arc_lengths="file", options="given")
    alone = dlo.calibrate(scene, shapes, **options)
    assert alone.bending_stiffness is None and alone.to_toml() == ""
    fit = dlo.calibrate(scene, shapes, predict=True, **options)
    assert fit.bending_stiffness is None and "No material" in fit.to_toml()
    rod = dlo.solve(scene, samples=shapes[0][0].shape[0], calibrated=fit)
    numpy.testing.assert_allclose(rod.points, shapes[0][0], atol=1e-3 * scene.length)


def test_the_calibrated_rod_is_turned_by_its_rotation(cable):
    """The `rotation` in a calibrated file rotates the clamp of the scene."""
    text = MATERIAL.replace("4e9", "5e6").replace("2000", "1150")
    fit = dlo._documents.MaterialFit(None, text + '[[gripper]]\nnumber = 1\nrotation = [0, 0, "20 deg"]\n')
    raised = cable.copy()
    raised.grippers[0].direction = "50 deg"
    numpy.testing.assert_allclose(
        dlo.solve(cable, samples=9, calibrated=fit).points, dlo.solve(raised, samples=9).points, atol=1e-9)


@pytest.mark.parametrize("text", [
    "natural_curvature = 1\n",
    MATERIAL,
    FOUND.replace("number = 2", "number = 3"),
    FOUND.replace("natural_curvature", "natural_curvatur"),
])
def test_refusals_are_the_commands(wire, found, command, text):
    found.write_text(text)
    done = subprocess.run([command, "solve", wire, "--calibrated", found], capture_output=True, text=True)
    assert done.returncode == 2
    with pytest.raises(dlo.InputError) as refused:
        dlo.solve(wire, calibrated=found)
    assert done.stderr.strip().endswith(str(refused.value))


def test_arguments_that_are_no_calibration_are_told(wire):
    refuses("calibrated: a int .allowed: a dlo.MaterialFit or dlo.MotionFit, or", dlo.solve, wire, calibrated=3)
    refuses("none.toml", dlo.check, wire, [[0, 0, 0], [1, 0, 0]], calibrated="none.toml")
