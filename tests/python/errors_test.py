"""Tests of errors, signals and threads."""

import itertools
import os
import signal
import subprocess
import threading
import time

import numpy
import pytest

from conftest import refuses

import dlo


def test_points_that_are_none_are_input_errors(cable):
    for points, words in [
        (numpy.zeros((3,)), r"shape \(3,\)"),
        ([["a", "b", "c"]], "no array of numbers"),
        (numpy.zeros((4, 3)), "the same as the point before"),
        ([[0, 0, 0]], r"1 point \(allowed: 2"),
        ([[0, 0, 0], [0, numpy.nan, 0]], "point 2: y = nan"),
    ]:
        refuses(words, dlo.check, cable, points)
    refuses("energies", dlo.solve, cable, model="energies")
    refuses("time_limt", dlo.solve, cable, time_limt=1)


def test_what_does_not_converge_says_so(cable):
    with pytest.raises(dlo.ConvergenceError) as caught:
        dlo.solve(cable, model="force", max_steps=10)
    assert isinstance(caught.value, RuntimeError)
    assert "did not come to rest" in str(caught.value)


def test_a_shape_that_is_left_open_is_part_of_the_error():
    # Straight up at the load at which it buckles: Gamma = 7.8373474389.
    scene = dlo.Scene(
        length=1,
        bending_stiffness=1,
        mass_per_length=7.8373474389 / 9.81,
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction=(0, 1, 0))],
    )
    with pytest.raises(dlo.ConvergenceError) as caught:
        dlo.solve(scene, samples=11)
    assert caught.value.result.points.shape == (11, 3)
    assert caught.value.result.status == "near_singular"


SCENE = """
import dlo
scene = dlo.Scene(length=1, diameter="5 mm", material="silicone",
                  grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction=0.0)],
                  force_model={"points": 2000, "law": "hooke"})
"""

INTERRUPTED = SCENE + """
import os, signal, threading, time
threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
begin = time.monotonic()
try:
    WHAT
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - begin < 10)
"""


@pytest.mark.parametrize(
    "what",
    [
        "dlo.solve(scene, model='force', time_limit=60, rest_tolerance=1e-9)",
        "dlo.ForceModel(scene).step(10**9)",
        "dlo.sweep(scene, {'gamma': 'lin:1:2:1000000'})",
        "dlo.bench(scene, seconds=600, repeats=1000)",
    ],
)
def test_ctrl_c_ends_long_calls(what, interpreter):
    done = subprocess.run(
        [*interpreter, "-c", INTERRUPTED.replace("WHAT", what)], capture_output=True, text=True
    )
    assert done.stdout == "interrupted True\n", done.stderr


def test_other_threads_run_meanwhile(cable):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    loop = dlo.ForceModel(cable)
    counter.start()
    loop.step(300_000)
    done.set()
    counter.join()
    assert counted > 3


def test_threads_get_what_one_gets(cable):
    expected = dlo.solve(cable, samples=11).points
    loop = dlo.ForceModel(cable)
    seen = []

    def work():
        for _ in range(20):
            seen.append(numpy.array_equal(dlo.solve(cable, samples=11).points, expected))
            loop.step(100)
            loop.points()

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == [True] * 80
    assert loop.steps == 8000


def resident():
    """Returns the resident memory of this process [bytes]."""
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_does_not_grow(steel, sanitized):
    if sanitized:
        pytest.skip("the sanitizer keeps for a while what is given back")

    def work(times):
        for _ in range(times):
            dlo.solve(steel, samples=11)
            with pytest.raises(dlo.InputError):
                dlo.solve(steel, model="none")
            with pytest.raises(dlo.InputError):
                steel.length = -1

    work(300)
    before = resident()
    work(1500)
    # The limit is 333 bytes for each repetition.
    assert resident() - before < 500_000


HANDLED = SCENE + """
import signal
loop, batch = dlo.ForceModel(scene), dlo.Batch([scene])
free = dlo.ForceModel(scene)
def handle(*_):
    free.step(10)  # one that nobody uses
    WHAT
signal.signal(signal.SIGALRM, handle)
signal.setitimer(signal.ITIMER_REAL, 0.3)
try:
    BUSY
except RuntimeError as error:
    print(error)
print(free.steps, len(loop.points()), len(batch.points()))  # nothing is left locked
"""


@pytest.mark.parametrize(
    "busy, what",
    [
        ("loop.step(10**9)", "loop.points()"),
        ("loop.step(10**9)", "loop.step()"),
        ("loop.rest(1e-15, 10**9, 60)", "loop.rest()"),
        ("batch.step(10**9)", "batch.points()"),
    ],
)
def test_a_handler_that_uses_the_busy_loop_is_told(busy, what, interpreter):
    script = HANDLED.replace("WHAT", what).replace("BUSY", busy)
    done = subprocess.run([*interpreter, "-c", script], capture_output=True, text=True, timeout=60)
    assert "a call of this object within another one of the same thread" in done.stdout, done.stderr
    assert done.stdout.endswith("\n10 2000 1\n")


LEFT = SCENE + """
import threading, time
loop, batch = dlo.ForceModel(scene), dlo.Batch([scene])
def work():
    while True:
        WHAT
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
time.sleep(0.2)
print("leaving")
"""


@pytest.mark.parametrize(
    "what",
    [
        "loop.step(10**9)",
        # Two that wait for the third: the first to get the loop keeps it from nobody.
        "loop.step(10**9) if threading.current_thread().name[:8] == 'Thread-1' else loop.points()",
        "batch.step(30)",
        "dlo.solve(scene)",
        "loop.rest(1e-15, 10**9, 60)",
    ],
)
def test_threads_of_daemons_do_not_disturb_the_end(what, interpreter):
    script = LEFT.replace("WHAT", what)
    for _ in range(3):
        # What is left would take hours: the time limit is far from either.
        done = subprocess.run([*interpreter, "-c", script], capture_output=True, text=True, timeout=120)
        assert (done.returncode, done.stdout, done.stderr) == (0, "leaving\n", "")


def test_arguments_of_a_wrong_kind_are_named(cable):
    loop, batch = dlo.ForceModel(cable), dlo.Batch([cable])
    points = loop.points()
    for call, words in [
        (lambda: dlo.solve(cable, samples="a"), r"samples = 'a': a str \(allowed: an integer\)"),
        (lambda: dlo.solve(cable, samples=2**40), r"samples = 1099511627776: out of range \(allowed"),
        (lambda: dlo.solve(cable, model=3), r"model = 3: a int \(allowed: text\)"),
        (lambda: dlo.solve(cable, model="\ud800"), r"model = .*unpaired surrogate \(allowed: Unicode"),
        (lambda: dlo.solve(cable, max_steps=1.5), r"max_steps = 1.5: a float \(allowed: an integer"),
        (lambda: dlo.solve(cable, terms=2**70), r"terms = 1180591620717411303424: out of range \(allowed"),
        (lambda: dlo.solve(cable, time_limit="1 s"), r"time_limit = '1 s': a str \(allowed: a number"),
        (lambda: dlo.solve(3), r"scene: a int \(allowed: a dlo.Scene, or the name of a scene file"),
        (lambda: dlo.check(cable, points, modulus=points), r"modulus = .*\(allowed: True or False"),
        (lambda: dlo.calibrate(3), r"scenes = 3: a int \(allowed: a list"),
        (lambda: dlo.stability(steppers=[1]), r"steppers = \[1\]: a int \(allowed: a list of text"),
        (lambda: dlo.sweep(cable, 3), r"vary = 3: a int \(allowed: a dict"),
        (lambda: dlo.sweep(cable, {3: "1"}), r"vary: a field = 3: a int \(allowed: text"),
        (lambda: dlo.ForceModel(cable, grip_stiffness="1"), r"grip_stiffness = '1': a str \(allowed"),
        (lambda: dlo.Batch(cable, threads=1), r"scenes = .*: a Scene \(allowed: a list"),
        (lambda: loop.move_gripper(-1, (0, 0, 0)), r"gripper = -1: out of range \(allowed: an integer f"),
        (lambda: batch.move_gripper(0.5, 0, (0, 0, 0)), r"rod = 0.5: a float \(allowed: an integer f"),
        (lambda: cable.replace(force_model={1: 2}), r"force_model: a key = 1: a int \(allowed: text"),
        (lambda: dlo.solve(cable).plot("x.svg"), r"ax = 'x.svg': a str \(allowed: axes of matplotlib, or None; plot"),
        (lambda: dlo.Scene.from_text(b""), r"text = b'': a bytes \(allowed: text"),
        (lambda: dlo.Scene.from_file("\ud800"), r"scene: a file's name with an unpaired surrogate"),
    ]:
        refuses(words, call)
    dlo.solve(cable, samples=numpy.int64(11), time_limit=numpy.float32(20))
    loop.step(count=numpy.int32(2))
    assert loop.steps == 2


def test_a_sweep_is_a_table_of_at_most_a_million_rows(cable):
    allowed = r"allowed: 1000000 in a table; more in parts, or by the command dlo sweep"
    for vary, rows in [
        ({"gamma": "lin:1:2:1000001"}, 1000001),
        ({"gamma": "lin:1:2:1001", "rod.length": "lin:1:2:1000"}, 1001000),
        ({"gamma": itertools.count(1)}, 1000001),
    ]:
        refuses(rf"sweep: {rows} combinations \({allowed}", dlo.sweep, cable, vary)
