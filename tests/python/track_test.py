"""Tests of rods while their grippers move."""

import numpy
import pytest
from conftest import refuses, without_times

import dlo


@pytest.fixture
def swung(root):
    return root / "data/scenes/swung_rod.toml"


def test_track_is_the_commands(swung, command_json):
    found = dlo.track(
        swung, end=0.1, frame_rate=50, step_rate=3000, dynamic=True, damping=0.01, samples=9
    )
    options = "--to 0.1 --frame-rate 50 --step-rate 3000 --dynamic --damping 0.01 --samples 9"
    assert without_times(found.json) == command_json("track", swung, *options.split(), "--shapes")
    assert "dynamic frames" in str(found)


def test_track_has_arrays_of_all_frames(swung):
    found = dlo.track(
        swung, end=0.1, frame_rate=50, force=False, dynamic=True, drag=0.02, samples=9
    )
    numpy.testing.assert_allclose(found.time, [0, 0.02, 0.04, 0.06, 0.08, 0.1], rtol=1e-12)
    assert found.points.shape == found.moving_points.shape == (6, 9, 3)
    assert found.arc_length.shape == (9,)
    for forces in (found.gripper_forces, found.moving_gripper_forces):
        assert forces.shape == (6, 1, 3)
    assert found.gripper_torques.shape == found.moving_gripper_torques.shape == (6, 1, 3)
    # From the same shape at rest, then the tip stays behind; both are held by the same gripper.
    numpy.testing.assert_allclose(found.moving_points[0], found.points[0], atol=1e-9)
    apart = numpy.linalg.norm(found.moving_points - found.points, axis=2)
    assert apart[:, 0].max() < 1e-12
    assert apart[-1, -1] > 0.01


def test_a_part_of_a_track_is_the_commands(root, command_json):
    scene = root / "data/scenes/corner_routing.toml"
    found = dlo.track(scene, begin=0.2, end=0.3, frame_rate=50, obstacle_rate=20, force=False, samples=5)
    options = "--from 0.2 --to 0.3 --frame-rate 50 --obstacle-rate 20 --no-force --samples 5"
    assert without_times(found.json) == command_json("track", scene, *options.split(), "--shapes")
    numpy.testing.assert_allclose(found.time, [0.2, 0.22, 0.24, 0.26, 0.28, 0.3], rtol=1e-12)


def test_track_says_what_is_wrong(swung, root):
    at_rest = dlo.track(swung, end=0.1, frame_rate=50, force=False)
    with pytest.raises(dlo.InputError, match="dynamic=True"):
        at_rest.moving_points
    refuses("dynamic=True", dlo.track, swung, damping=0.01)
    refuses("out of range", dlo.track, swung, frame_rate=0)
    refuses("material_damping", dlo.track, swung, end=0.1, frame_rate=50, force=False, dynamic=True, damping=-1)
    refuses("nothing moves", dlo.track, root / "data/scenes/cable.toml")


def test_track_that_stops_has_what_was_before():
    scene = dlo.Scene.from_text("""
        rod = {length = 1, diameter = 0.01, material = "silicone"}
        [[gripper]]
        at = 0
        position = [0, 0, 0]
        hold = "pin"
        [[gripper]]
        at = 1
        hold = "pin"
        pose = [{time = 0, position = [0.9, 0, 0]}, {time = 1, position = [1.1, 0, 0]}]
    """)
    with pytest.raises(dlo.ConvergenceError, match="stopped at 0.5 s") as caught:
        dlo.track(scene, frame_rate=20, force=False)
    assert caught.value.result.time.shape == (10,)


def swung_wire(stiffness):
    return dlo.Scene.from_text(f"""
        rod = {{length = 0.4, bending_stiffness = {stiffness}, mass_per_length = 0.05}}
        [[gripper]]
        at = 0
        direction = "-60 deg"
        pose = [{{time = 0, position = [0, 0, 0]}}, {{time = 0.3, position = [0.1, 0.02, 0]}}]
    """)


def recorded():
    """Returns the rows of markers of a swinging rod, and their times."""
    way = dlo.track(swung_wire(0.02), frame_rate=40, force=False, samples=5, dynamic=True, damping=0.01)
    rows = [
        [time, s, *point]
        for time, points in zip(way.time, way.moving_points)
        for s, point in zip(way.arc_length, points)
    ]
    return numpy.array(rows), way.time


def as_file(rows, file):
    numpy.savetxt(file, rows, fmt="%.17g", delimiter=",", header="time,s,x,y,z", comments="")
    return file


def test_stiffness_from_a_recorded_motion(tmp_path):
    rows, _ = recorded()
    for motion in (rows, as_file(rows, tmp_path / "markers.csv")):
        found = dlo.calibrate(swung_wire(0.021), motion=motion)
        assert abs(found.json["stiffness"]["value"] / 0.02 - 1) < 1e-3
    refuses("allowed", dlo.calibrate, swung_wire(0.03), motion=[[0.0, 1.0]])
    as_found = dict(dynamic=True, calibrated=found)
    assert dlo.check(swung_wire(0.021), motion=rows, tolerance="0.01%", **as_found).passed
    moved = dlo.track(swung_wire(0.021), frame_rate=40, force=False, **as_found)
    damped = dlo.track(swung_wire(0.021), frame_rate=40, force=False, damping=0.2, **as_found)
    for way, damping in (moved, found.json["damping_s"]["value"]), (damped, 0.2):
        assert way.json["dynamic"]["damping_s"] == pytest.approx(damping, rel=1e-7)


def test_a_recorded_motion_is_judged(tmp_path):
    """A recording of a rod with inertia passes with inertia and fails without it; a late recording has a lag."""
    scene = swung_wire(0.02)
    rows, times = recorded()
    right = dlo.check(scene, motion=rows, dynamic=True, damping=0.01, tolerance="0.1%")
    assert isinstance(right, dlo.MotionCheck)
    assert right.passed and right.rms < 1e-5 and right.largest >= right.rms
    assert right.lag is None and right.causes == []
    assert numpy.allclose(right.time, times)
    assert right.errors.shape == times.shape
    wrong = dlo.check(scene, motion=rows, damping=0.01, tolerance="0.1%")
    assert not wrong.passed and "allowed 0.4 mm" in wrong.reason
    assert wrong.causes[0][0] == "the rod has inertia (--dynamic)"
    late = rows + [0.02, 0, 0, 0, 0]
    for motion in (late, as_file(late, tmp_path / "late.csv")):
        found = dlo.check(scene, motion=motion, dynamic=True, damping=0.01, begin=0)
        assert abs(found.lag - 0.02) < 1e-4
    assert dlo.check(scene, motion=late, begin=0, explain=False).causes == []
    refuses("points and motion", dlo.check, scene, [[0, 0, 0], [1, 0, 0]], motion=rows)
    refuses("allowed: points, or motion", dlo.check, scene)
