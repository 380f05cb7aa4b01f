"""Tests of the suite's schemas with a validator: committed answers, a new card, and invalid documents."""

import copy
import json
import os
import pathlib
import subprocess

import pytest

jsonschema = pytest.importorskip("jsonschema", reason="python3-jsonschema is not installed")

ROOT = pathlib.Path(os.environ["DLO_ROOT"])
SUITE = ROOT / "data/suite"
ANSWERS = SUITE / "answers"


def validator(name):
    schema = json.loads((SUITE / name).read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


VALIDATORS = {
    "dlo/answer/1": validator("schema.json"),
    "dlo/motion/1": validator("motion_schema.json"),
    "dlo/card/1": validator("card_schema.json"),
}


def errors(document):
    return [error.message for error in VALIDATORS[document["schema"]].iter_errors(document)]


def test_committed_answers_are_valid():
    index = json.loads((ANSWERS / "suite.json").read_text())
    kinds = set()
    for entry in index["answers"]:
        answer = json.loads((ANSWERS / entry["answer"]).read_text())
        assert errors(answer) == [], entry["id"]
        kinds.add(answer["schema"])
    assert kinds == {"dlo/answer/1", "dlo/motion/1"}


@pytest.mark.parametrize("scenes", ["bending_small,strip_flat", "motion_vibration"])
def test_a_fresh_card_is_valid(scenes):
    command = [os.environ["DLO_COMMAND"], "suite", "--with", "chain", "--scenes", scenes, "--points", "8", "--format", "json"]
    card = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert errors(card) == []
    card["cards"][0]["scenes"][0]["runs"][0]["status"] = "nearly"
    assert errors(card) != []


@pytest.mark.parametrize(
    "answer, change",
    [
        ("weight_10", lambda a: a.pop("methods")),
        ("weight_10", lambda a: a.update(methods=["energy"])),
        ("weight_10", lambda a: a.update(points_bound_m=-1e-9)),
        ("weight_10", lambda a: a["points_m"][3].append(0.0)),
        ("weight_10", lambda a: a["grippers"][0].update(force_N="0.03 N")),
        ("motion_release", lambda a: a.pop("times_s")),
        ("motion_release", lambda a: a.update(damping=0.1)),
        ("motion_release", lambda a: a["frames_m"][2][5].pop()),
    ],
)
def test_a_mutated_answer_is_not(answer, change):
    right = json.loads((ANSWERS / f"{answer}.json").read_text())
    wrong = copy.deepcopy(right)
    change(wrong)
    assert errors(right) == []
    assert errors(wrong) != []
