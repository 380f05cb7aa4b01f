# test_cable.py
import dlo

import simulate


def test_the_cable_hangs_as_it_should():
    arc_length, points = simulate.simulate(20)
    check = dlo.check("cable.toml", points, arc_length=arc_length, tolerance="1%")
    assert check.passed, check.reason
