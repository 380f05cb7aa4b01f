"""Tests of dlo.suite: simulators that are functions, correct or with deliberate errors."""

import importlib.util
import json
import math
import os
import pathlib
import time

import numpy
import pytest

from conftest import refuses

import dlo

ROOT = pathlib.Path(os.environ["DLO_ROOT"])
SPECIFICATION = importlib.util.spec_from_file_location("simulator", ROOT / "tests/compare/suite/simulator.py")
simulator = importlib.util.module_from_spec(SPECIFICATION)
SPECIFICATION.loader.exec_module(simulator)

def rod(scene, points):
    return dlo.solve(scene, samples=points)


def polygon(scene, points):
    scene.force_model.points = points
    return dlo.solve(scene, "chain")


def chain(defect):
    def run(scene, points):
        document = scene.document(points)
        problem = simulator.not_supported(document)
        if problem:
            raise NotImplementedError(problem)
        return simulator.shape(defect, document, points)

    return run


def another_equilibrium(scene, points):
    stable = [state for state in dlo.solve_all(scene, points) if state.stable]
    if len(stable) < 2:
        raise NotImplementedError("scenes with one equilibrium")
    return stable[1]


@pytest.mark.parametrize("run", [rod, polygon, chain("right")])
def test_no_cause_is_found_in_what_is_right(run):
    card = dlo.suite(run, scenes=["bending_large", "weight_10", "payload_tip"], name="right")
    assert card.causes == {}
    assert card.right == 3
    assert "right: 3 of 3 scenes right" in str(card)


@pytest.mark.parametrize(
    "run, scenes, cause",
    [
        (chain("caps"), ["weight_10"], "weight with caps"),
        (chain("limp"), ["weight_10"], "bending stiffness ignored"),
        (another_equilibrium, ["strip_edge_above", "weight_10"], "other equilibrium"),
    ],
)
def test_what_is_wrong_is_named(run, scenes, cause):
    card = dlo.suite(run, scenes=scenes, name="mutated")
    assert set(card.causes) == {cause}, str(card)
    assert card.right == 0


def test_what_is_not_supported_is_no_failure_and_what_fails_says_why():
    def run(scene, points):
        if scene.loads:
            raise NotImplementedError("loads")
        if scene.natural_curvature is not None:
            raise ValueError("a bad day\nand more")
        return numpy.zeros((points, 4))

    card = dlo.suite(run, scenes=["payload_tip", "curved_hose", "weight_1"])
    by_id = {scene["id"]: scene for scene in card.card["scenes"]}
    assert by_id["payload_tip"]["status"] == "not supported"
    assert by_id["payload_tip"]["runs"][0]["problem"] == "NotImplementedError: loads"
    assert by_id["curved_hose"]["runs"][0]["problem"] == "ValueError: a bad day"
    assert by_id["weight_1"]["status"] == "failed"
    assert "points" in by_id["weight_1"]["runs"][0]["problem"]


def test_a_card_is_the_commands():
    card = dlo.suite(rod, scenes=["weight_1"], points=8, threads=1)
    assert card["schema"] == "dlo/card/1"
    assert card.json == json.loads(card.to_json())
    assert card.card["points"] == [8, 16, 32]
    assert "| weight | 1 of 1 |" in card.to_markdown()
    assert 'tests="1" failures="0"' in card.to_junit()
    assert 'class="badge' in card.to_html()


def test_arc_lengths_may_be_given_and_ctrl_c_ends_it():
    def pair(scene, points):
        shape = rod(scene, points)
        return shape.points, shape.arc_length

    assert dlo.suite(pair, scenes=["weight_1"]).right == 1

    def interrupted(scene, points):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dlo.suite(interrupted, scenes=["weight_1"], threads=1)


def test_finished_runs_are_not_run_again(tmp_path):
    calls = []

    def counted(scene, points):
        calls.append((scene.name, points))
        if len(calls) == 5:
            raise KeyboardInterrupt
        if scene.loads:
            raise NotImplementedError("loads")
        return rod(scene, points)

    few = ["weight_1", "payload_tip", "weight_10"]
    options = {"scenes": few, "points": 8, "threads": 1, "state": tmp_path / "runs"}
    with pytest.raises(KeyboardInterrupt):
        dlo.suite(counted, **options)
    first = dlo.suite(counted, **options)
    # Three runs of two scenes, one of that which is not supported, and the one that was interrupted.
    assert len(calls) == 3 + 3 + 1 + 1
    assert sorted(path.name for path in (tmp_path / "runs/counted").iterdir()) == sorted(
        [f"{scene}_{points}.json" for scene in few[::2] for points in (8, 16, 32)] + ["payload_tip_8.json"])
    again = dlo.suite(counted, **options)
    assert len(calls) == 8 and again.json == first.json  # the times too are those that were kept
    dlo.suite(counted, **{**options, "name": "another", "scenes": ["weight_1"]})
    assert len(calls) == 11


def test_a_baseline_is_that_of_the_command(tmp_path):
    options = {"scenes": ["weight_1"], "points": 8, "name": "mine"}
    assert dlo.suite(polygon, **options).passed is None
    baseline = tmp_path / "errors.toml"
    written = dlo.suite(polygon, baseline=baseline, update=True, **options)
    assert written.passed and written.reason == f"{baseline} written"
    same = dlo.suite(polygon, baseline=baseline, **options)
    assert same.passed and same.reason == "3 same"
    better = dlo.suite(rod, baseline=baseline, **options)
    assert better.passed and better.reason.split()[:2] == ["better", "weight_1"]
    worse = dlo.suite(chain("welded"), baseline=baseline, **options)
    assert worse.passed is False and worse.reason.endswith("3 worse")
    # Errors are shares of the length, below 1.
    assert dlo.suite(rod, baseline=baseline, absolute=1, **options).reason == "3 same"


def endless(scene, points):
    while True:
        try:
            sum(range(points))
        except Exception:  # nor does that go on
            continue


def slept(scene, points):
    time.sleep(1)  # in C, which is not ended
    return rod(scene, points)


def swallowed(scene, points):
    try:
        while True:
            sum(range(points))
    except BaseException:
        return rod(scene, points)


@pytest.mark.parametrize("run", [endless, slept, swallowed])
def test_a_run_ends_at_the_time_limit_or_is_late(run):
    card = dlo.suite(run, scenes=["weight_1"], time_limit=0.5)
    assert card.card["total"]["failed"] == 1
    assert "ended after the time limit of 0.5 s" in card.card["scenes"][0]["runs"][0]["problem"]


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"run": 3}, "run: a int .allowed: a function"),
        ({"scenes": ["wieght"]}, "did you mean weight"),
        ({"points": 2}, "points from 4"),
        ({"scenes": "weight"}, "scenes = 'weight'"),
        ({"name": "../rod", "state": "runs"}, "name = .../rod.: no folder of state"),
        ({"baseline": "none.toml", "update": True, "relative": math.nan}, "relative and absolute >= 0"),
        ({"baseline": 3}, "baseline: a int .allowed: the name of a file"),
        ({"state": 3}, "state: a int .allowed: the name of a folder"),
    ],
)
def test_bad_arguments_are_told_by_name(arguments, words):
    refuses(words, dlo.suite, **{"run": rod, **arguments})


def test_a_scene_as_a_document_has_the_polygon_that_is_asked_for():
    scene = dlo.Scene.from_file(ROOT / "data/suite/scenes/weight_1.toml")
    document = scene.document(9)
    assert document["schema"] == "dlo/scene/1"
    assert len(document["force_model"]["point_at_m"]) == 9
