"""Tests of baselines and reports: Python gives the results of the command."""

import json
import subprocess
import xml.etree.ElementTree

import pytest

from conftest import refuses

import dlo

SCENE = "data/scenes/spring_steel_175.toml"


def run(command, *arguments):
    return subprocess.run([command, *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture
def scene(root):
    scene = dlo.Scene.from_file(root / SCENE)
    scene.force_model = {"points": 12}
    return scene


def test_regress_is_the_commands(root, command, tmp_path):
    ours, theirs = tmp_path / "ours.toml", tmp_path / "theirs.toml"
    written = dlo.regress(root / SCENE, ours, model="chain", update=True)
    done = run(command, "regress", root / SCENE, "--baseline", theirs, "--model", "chain", "--update")
    assert done.returncode == 0, done.stderr
    assert ours.read_text() == theirs.read_text()
    assert str(written) == done.stdout and written.passed and written.reason == f"{ours} written"
    found = dlo.regress([root / SCENE], theirs, model="chain")
    done = run(command, "regress", root / SCENE, "--baseline", ours, "--model", "chain", "--format", "json",
               "--junit", tmp_path / "dlo.xml")
    assert found.json == json.loads(done.stdout)
    assert found.to_junit() == (tmp_path / "dlo.xml").read_text()
    assert xml.etree.ElementTree.fromstring(found.to_junit()) is not None
    assert found.passed and found.reason == "1 same" and repr(found) == "<dlo.Regression pass: 1 same>"


def test_regress_fails_what_has_changed(scene, tmp_path):
    baseline = tmp_path / "shapes.toml"
    refuses("shapes.toml", dlo.regress, scene, baseline, model="chain")
    dlo.regress(scene, baseline, model="chain", update=True)
    scene.gravity = (0, -9, 0)
    found = dlo.regress(scene, baseline, model="chain")
    assert not found.passed and found["cases"][0]["verdict"] == "changed"
    assert dlo.regress(scene, baseline, model="chain", update=True).passed
    assert dlo.regress(scene, baseline, model="chain").passed
    before = baseline.read_text()
    with pytest.raises(dlo.ConvergenceError, match="left as it was") as caught:
        dlo.regress(scene, baseline, update=True, max_steps=10)
    assert not caught.value.result.passed
    assert baseline.read_text() == before
    for call, words in [
        (lambda: dlo.regress(scene, baseline, model="exact"), "allowed: force, chain"),
        (lambda: dlo.regress(scene, 3), r"baseline: a int \(allowed: the name of a file"),
        (lambda: dlo.regress(scene, baseline, time=1), "nothing moves"),
        (lambda: dlo.regress(scene, baseline, relative="1%"), r"relative = '1%': a str \(allowed: a number"),
    ]:
        refuses(words, call)
