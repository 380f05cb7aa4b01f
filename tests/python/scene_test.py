"""Scenes: the same whether read or built, and the same errors."""

import math
import pickle

import numpy
import pytest

import dlo

TEXT = """
name = "two metres"
[rod]
length = "2 m"
diameter = "6 mm"
material = "silicone"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "30 deg"
hold = "clamp"
[[load]]
at = "2 m"
mass = "10 g"
[[obstacle]]
point = [0, "-5 m", 0]
normal = [0, 1, 0]
[force_model]
points = 20
"""


def built():
    return dlo.Scene(
        name="two metres",
        length="2 m",
        diameter="6 mm",
        material="silicone",
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")],
        loads=[dlo.load(at="2 m", mass="10 g")],
        obstacles=[dlo.obstacle(point=(0, "-5 m", 0), normal=(0, 1, 0))],
        force_model={"points": 20},
    )


def test_a_scene_in_code_is_that_of_its_file():
    read = dlo.Scene.from_text(TEXT)
    in_code = built()
    for scene in (read, in_code, dlo.Scene.from_text(in_code.to_toml()), read.copy()):
        assert scene.name == "two metres"
        assert (scene.length, scene.diameter) == (2.0, 0.006)
        numpy.testing.assert_array_equal(scene.gravity, [0, -9.81, 0])
        gripper = scene.grippers[0]
        assert (gripper.at, gripper.hold) == (0.0, "clamp")
        angle = math.radians(30)
        numpy.testing.assert_allclose(
            gripper.direction, [math.cos(angle), math.sin(angle), 0], rtol=1e-15
        )
        assert (scene.loads[0].at, scene.loads[0].mass) == (2.0, 0.01)
        numpy.testing.assert_array_equal(scene.obstacles[0].point, [0, -5, 0])
        assert scene.force_model.points == 20
        assert scene.force_model.law == "hooke"
    assert dlo.solve(read, samples=5).json["points_m"] == dlo.solve(in_code, samples=5).json[
        "points_m"
    ]


def test_every_field_can_be_set_and_read(steel):
    steel.length = "60 cm"
    assert steel.length == 0.6
    steel.diameter = 0.003
    steel.material = {"youngs_modulus": "100 GPa", "density": 8000}
    assert (steel.youngs_modulus, steel.density) == (1e11, 8000)
    assert steel.bending_stiffness == pytest.approx(1e11 * math.pi * 0.003**4 / 64, rel=1e-14)
    steel.bending_stiffness = "0.5 N m^2"
    assert steel.bending_stiffness == 0.5
    steel.mass_per_length = "20 g/m"
    assert steel.mass == pytest.approx(0.012, rel=1e-14)
    assert steel.gamma == pytest.approx(0.02 * 9.81 * 0.6**3 / 0.5, rel=1e-14)
    steel.bending_stiffness = None
    steel.torsional_stiffness = 0.3
    assert steel.torsional_stiffness == 0.3
    steel.natural_curvature = "1 1/m"
    assert steel.natural_curvature == 1
    steel.natural_curvature = None
    steel.gravity = (0, 0, "-9.81 m/s^2")
    numpy.testing.assert_array_equal(steel.gravity, [0, 0, -9.81])
    steel.grippers[0].position = numpy.array([0, 0.1, 0])
    numpy.testing.assert_array_equal(steel.grippers[0].position, [0, 0.1, 0])
    steel.grippers += (dlo.pin(at="60 cm", position=(0.5, 0.1, 0)),)
    assert [gripper.hold for gripper in steel.grippers] == ["clamp", "pin"]
    steel.grippers = steel.grippers[:1]
    steel.loads = [dlo.load(at=0.6, force=(0, "-10 mN", 0))]
    steel.loads[0].force = (0, 0, 1)
    numpy.testing.assert_array_equal(steel.loads[0].force, [0, 0, 1])
    steel.sections = [dlo.section("10 cm", "20 cm", bending_stiffness=2)]
    assert (steel.sections[0].start, steel.sections[0].end) == (0.1, 0.2)
    steel.force_model.points = 32
    steel.force_model.law = "hooke"
    steel.force_model = {"points": 24}
    assert steel.force_model.points == 24


@pytest.mark.parametrize(
    "change, key, words",
    [
        (lambda s: setattr(s, "length", "30 inch"), "rod.length", 'unknown unit "inch"'),
        (lambda s: setattr(s, "material", "silcone"), "rod.material", "silicone"),
        (lambda s: setattr(s.grippers[0], "at", 3), "gripper.at", "0 to 0.5 m"),
        (lambda s: setattr(s.force_model, "points", 2), "force_model.points", "4"),
        (lambda s: setattr(s, "loads", [dlo.load(at=0.1, force=(0, 1))]), "load.force", "three"),
        (lambda s: s.replace(diameter=-1), "rod.diameter", "allowed"),
    ],
)
def test_errors_name_the_key_and_leave_the_scene_as_it_was(steel, change, key, words):
    before = steel.to_toml()
    with pytest.raises(dlo.InputError) as caught:
        change(steel)
    assert caught.value.key == key
    assert words in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert steel.to_toml() == before
    assert steel.length == 0.5


def test_errors_of_files_name_file_and_line(tmp_path):
    path = tmp_path / "inch.toml"
    path.write_text('# inch\n[rod]\nlength = "30 inch"\n')
    with pytest.raises(dlo.InputError, match=r"inch\.toml:3: rod\.length = '30 inch'"):
        dlo.Scene.from_file(path)
    with pytest.raises(dlo.InputError, match="missing.toml"):
        dlo.solve(tmp_path / "missing.toml")


def test_scenes_can_be_pickled(cable):
    assert pickle.loads(pickle.dumps(cable)) == cable


def test_a_copy_is_changed_alone(cable):
    copy = cable.copy()
    copy.grippers[0].direction = (0, 1, 0)
    assert cable != copy
    assert cable.grippers[0].direction[0] > 0.8


def test_numbers_survive_the_way_through_text(cable):
    cable.length = 1 / 3
    cable.gravity = (0, -numpy.pi, 1e-300)
    again = dlo.Scene.from_text(cable.to_toml())
    assert again.length == 1 / 3
    numpy.testing.assert_array_equal(again.gravity, [0, -numpy.pi, 1e-300])


def test_every_material_can_be_named(steel):
    found = dlo.materials()
    assert {"spring_steel", "silicone", "copper"} <= {material["name"] for material in found}
    for material in found:
        assert material["source"]
        steel.material = material["name"]
        assert steel.youngs_modulus == material["youngs_modulus"]
        assert steel.density == material["density"]


def values_without_end():
    itself = [0, 0]
    itself.append(itself)
    table = {}
    table["in"] = table
    deep = []
    for _ in range(100_000):
        deep = [deep]

    class Same:
        def tolist(self):
            return self

    class New:
        def tolist(self):
            return [New()]

    return [itself, table, deep, Same(), New()]


def test_values_that_hold_themselves_are_refused(cable):
    for value in values_without_end():
        for key in ("gravity", "length", "natural_curvature", "material"):
            with pytest.raises(dlo.InputError, match=rf"{key}.*nested too deep \(allowed: 32 levels"):
                cable.replace(**{key: value})
        with pytest.raises(dlo.InputError, match="position.*nested too deep"):
            cable.replace(grippers=[dlo.clamp(at=0, position=value, direction=0)])
        with pytest.raises(dlo.InputError, match="nested too deep"):
            cable.force_model.c_b = value
    doubled = [0.0]
    for _ in range(30):
        doubled = [doubled, doubled]
    with pytest.raises(dlo.InputError, match=r"gravity: too many values \(allowed: 1000000 in"):
        cable.gravity = doubled
    assert cable.length == 1


def test_values_that_no_file_has_name_their_key(cable):
    for value, words in [
        ("\ud800", r"gravity: text with half a character \(allowed: Unicode"),
        (2**64, r"gravity: an integer out of range \(allowed: up to 64 bits"),
        ({1: 2}, r"gravity: a key that is a int \(allowed: text"),
        ((x for x in "abc"), r"gravity: a generator \(allowed: a number, text"),
        (1j, r"gravity: a complex \(allowed: a number, text"),
    ]:
        with pytest.raises(dlo.InputError, match=words):
            cable.gravity = value
