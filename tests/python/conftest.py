"""Fixtures and helpers of the Python tests."""

import ctypes
import gc
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import pytest

import dlo

# Under the preset asan this interpreter has been started with the sanitizers' runtime. The command has its
# own, and must not get another one.
PRELOADED = os.environ.pop("LD_PRELOAD", "")
SANITIZED = "asan" in PRELOADED


def leak_report():
    """Returns the sanitizer's report of leaked memory. The leak check runs in a child process, because it stops
    all threads, which may kill the process that calls it (observed once on a busy machine)."""
    for _ in range(3):
        with tempfile.TemporaryFile("w+") as report:
            child = os.fork()
            if child == 0:
                os.dup2(report.fileno(), 2)
                ctypes.CDLL(None).__lsan_do_recoverable_leak_check()
                os._exit(0)
            if os.waitpid(child, 0)[1] == 0:
                report.seek(0)
                return report.read()
    raise AssertionError("the leak check ended three times without a report")


@pytest.fixture(scope="session", autouse=True)
def no_leaks():
    """Checks in a sanitizer build that the module has leaked no memory at the end of all tests. Leaks of the
    interpreter and of other modules are ignored."""
    yield
    if SANITIZED:
        gc.collect()
        ours = re.compile(r"dlo::|/_dlo\.")  # a function of the module, by name or only by its file
        lost = [block for block in leak_report().split("\n\n") if ours.search(block)]
        assert not lost, "\n\n".join(lost)


@pytest.fixture
def sanitized():
    """Whether this is a sanitizer build."""
    return SANITIZED


@pytest.fixture
def interpreter():
    """Returns the command that starts another Python that can import dlo."""
    return ["env", "LD_PRELOAD=" + PRELOADED, sys.executable] if PRELOADED else [sys.executable]


@pytest.fixture
def root():
    """Returns the folder of the repository, whose data/ and pages are read."""
    return pathlib.Path(os.environ["DLO_ROOT"])


@pytest.fixture
def command():
    """Returns the path of the command dlo of the same build."""
    return os.environ["DLO_COMMAND"]


def refuses(words, function, *arguments, **options):
    """Expects that a call is refused with an InputError whose message matches `words`."""
    with pytest.raises(dlo.InputError, match=words):
        function(*arguments, **options)


def without_times(document):
    """Returns a document without the numbers that a clock has measured."""
    if isinstance(document, dict):
        times = ("wall_s", "force_s", "energy_s", "frame_s", "run_s")
        return {key: without_times(value) for key, value in document.items() if key not in times}
    return list(map(without_times, document)) if isinstance(document, list) else document


@pytest.fixture
def command_json(command):
    """Returns a function that runs the command with its arguments and returns the document without times."""
    def run(*arguments):
        words = [command, *map(str, arguments), "--format", "json"]
        done = subprocess.run(words, capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        return without_times(json.loads(done.stdout))

    return run


@pytest.fixture
def steel():
    """Returns a scene of the paper's rod, clamped horizontally: Gamma = 0.18."""
    return dlo.Scene(
        length="50 cm",
        diameter="2 mm",
        material="spring_steel",
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
    )


@pytest.fixture
def cable():
    """Returns a scene of a soft cable: Gamma = 361."""
    return dlo.Scene(
        length="1 m",
        diameter="10 mm",
        material={"youngs_modulus": "5 MPa", "density": 1150},
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")],
    )
