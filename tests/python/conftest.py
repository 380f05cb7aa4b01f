"""What the tests share."""

import os
import pathlib

import pytest

import dlo


@pytest.fixture
def root():
    """The repository, whose data/ and pages are read."""
    return pathlib.Path(os.environ["DLO_ROOT"])


@pytest.fixture
def command():
    """The command dlo of the same build."""
    return os.environ["DLO_COMMAND"]


@pytest.fixture
def steel():
    """The paper's rod, horizontal: Gamma = 0.18."""
    return dlo.Scene(
        length="50 cm",
        diameter="2 mm",
        material="spring_steel",
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
    )


@pytest.fixture
def cable():
    """A soft one: Gamma = 361."""
    return dlo.Scene(
        length="1 m",
        diameter="10 mm",
        material={"youngs_modulus": "5 MPa", "density": 1150},
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")],
    )
