"""Tests of the loop: it comes to rest at the solver's shape, and writes into given arrays."""

import numpy
import pytest

from conftest import refuses

import dlo


def test_it_comes_to_rest_where_solve_does(cable):
    cable.force_model = {"points": 20}
    solved = dlo.solve(cable, model="force")
    loop = dlo.ForceModel(cable)
    steps, error = loop.rest()
    assert steps == loop.steps > 0 and error < 1e-6
    points = loop.points()
    # The first point lies inside the gripper, half a segment back.
    numpy.testing.assert_allclose(points[1:], solved.points[1:], atol=1e-6)
    numpy.testing.assert_allclose(loop.reactions()[0, :3], solved.gripper_forces[0], atol=1e-6)
    numpy.testing.assert_allclose(loop.reactions()[0, 3:], solved.gripper_torques[0], atol=1e-6)


def test_it_writes_into_the_array_that_it_is_given(cable):
    loop = dlo.ForceModel(cable)
    out = numpy.empty((len(loop), 3))
    assert loop.points(out=out) is out
    loop.step(50)
    moved = loop.points(out=out).copy()
    numpy.testing.assert_array_equal(moved, loop.points())
    reactions = numpy.empty((1, 6))
    assert loop.reactions(out=reactions) is reactions
    for wrong in (numpy.empty((3, len(loop))), numpy.empty((len(loop), 3), dtype="f4"),
                  numpy.empty((len(loop), 6))[:, ::2], [[0.0]]):
        refuses("out", loop.points, out=wrong)
    out.flags.writeable = False
    refuses("read only", loop.points, out=out)


def held_at_both_ends(cable):
    cable.grippers += (dlo.pin(at=cable.length, position=(0.6, 0, 0)),)
    cable.force_model = {"points": 20}
    return cable


def test_between_two_grippers_it_starts_where_it_rests(cable):
    loop = dlo.ForceModel(held_at_both_ends(cable))
    start = loop.points()
    loop.rest()
    numpy.testing.assert_allclose(loop.points(), start, atol=1e-5)
    assert loop.points()[:, 1].min() < -0.3
    refuses("a pin has none", loop.move_gripper, 1, position=(0.5, 0, 0), direction=(1, 0, 0))
    loop.move_gripper(1, position=(0.5, 0, 0))
    loop.rest()
    numpy.testing.assert_allclose(loop.points()[-1], [0.5, 0, 0], atol=1e-12)


def test_it_starts_from_the_points_that_it_is_given(cable):
    rested = dlo.ForceModel(cable)
    rested.rest()
    again = dlo.ForceModel(cable, rested.points())
    assert again.energy() == pytest.approx(rested.energy(), rel=1e-12)
    again.rest()
    numpy.testing.assert_allclose(again.points(), rested.points(), atol=1e-6)
    refuses("3 points", dlo.ForceModel, cable, rested.points()[:3])


def test_energy_and_reactions_are_of_now_whatever_was_looked_at(cable):
    loop = dlo.ForceModel(cable)
    loop.points()
    loop.rest()
    energy = loop.energy()
    before = loop.points()
    assert energy == loop.energy() < dlo.ForceModel(cable).energy()
    loop.move_gripper(0, position=(0.2, 0.1, -0.1))
    loop.rest()
    assert loop.energy() - energy == pytest.approx(0.1 * cable.mass * 9.81, rel=1e-3)
    numpy.testing.assert_allclose(loop.points(), before + (0.2, 0.1, -0.1), atol=1e-5)
    loop.move_gripper(0, position=(0, 0.1, 0), direction=(0, -2, 0))
    loop.rest()
    numpy.testing.assert_allclose(loop.points()[:, 0], 0, atol=1e-4)
    reactions = loop.reactions()
    loop.points()
    numpy.testing.assert_array_equal(reactions, loop.reactions())


def test_it_says_what_it_cannot_do(cable):
    refuses("grip_stiffness = 0: out of range", dlo.ForceModel, cable, grip_stiffness=0)
    loop = dlo.ForceModel(cable)
    refuses("must not be the zero vector", loop.move_gripper, 0, position=(0, 0, 0), direction=(0, 0, 0))
    refuses(r"shape \(2,\)", loop.move_gripper, 0, position=(0, 0))
    refuses("gripper = 1", loop.move_gripper, 1, position=(0, 0, 0))
    refuses("wall = 0: no plane", loop.move_wall, 0, point=(0, 0, 0), normal=(0, 1, 0))
    with pytest.raises(dlo.ConvergenceError, match="did not come to rest: .* after 10 steps"):
        loop.rest(max_steps=10)


def test_a_moved_wall_lifts_the_rod(cable):
    cable.obstacles = [dlo.obstacle(point=(0, -5, 0), normal=(0, 1, 0))]
    loop = dlo.ForceModel(cable)
    loop.rest()
    assert loop.points()[-1, 1] < -0.3
    loop.move_wall(0, point=(0, -0.2, 0), normal=(0, 1, 0))
    loop.rest()
    # The surface touches, half a diameter from the axis.
    assert loop.points()[:, 1].min() == pytest.approx(-0.2 + 0.005, abs=1e-3)


def test_springs_give_what_a_hand_feels(cable):
    loop = dlo.ForceModel(cable, grip_stiffness=1000)
    loop.rest()
    weight = cable.mass * 9.81
    assert loop.reactions()[0, 1] == pytest.approx(weight, rel=0.05)
    assert not numpy.allclose(loop.points()[0], [0, 0, 0], atol=1e-6)


def test_a_batch_does_what_each_rod_does_alone(cable):
    scenes = [cable.replace(length=length) for length in numpy.linspace(0.5, 1, 10)]
    batch = dlo.Batch(scenes, threads=2)
    batch.step(500)
    together = batch.points()
    assert together.shape == (10, 16, 3) and not batch.diverged.any()
    for scene, points in zip(scenes, together):
        alone = dlo.ForceModel(scene)
        alone.step(500)
        numpy.testing.assert_allclose(points, alone.points(), atol=1e-9)
    batch.move_gripper(3, 0, position=(0, 1, 0))
    batch.step(1)
    assert batch.points(out=together)[3, 1, 1] > 0.9
