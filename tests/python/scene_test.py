"""Tests of scenes: a scene built in code equals the same scene from a file, and so do the errors."""

import math
import pickle

import numpy
import pytest

from conftest import refuses

import dlo

TEXT = """
name = "two metres"
rod = {length = "2 m", diameter = "6 mm", material = "silicone"}
gripper = [{at = 0, position = [0, 0, 0], direction = "30 deg", hold = "clamp"}]
load = [{at = "2 m", mass = "10 g"}]
obstacle = [{point = [0, "-5 m", 0], normal = [0, 1, 0]}]
force_model = {points = 20}
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
    steel.natural_curvature = "1 1/m"
    assert steel.natural_curvature == 1
    steel.natural_curvature = None
    steel.sections = [dlo.section("10 cm", "20 cm", bending_stiffness=2, natural_twist="90 deg/m")]
    steel.sections[0].natural_curvature = [0, "3 1/m"]
    assert steel.sections[0].natural_curvature.tolist() == [0, 3]
    assert steel.sections[0].natural_twist == pytest.approx(math.pi / 2, rel=1e-14)
    steel.sections = [dlo.section("10 cm", "20 cm", bending_stiffness=2)]
    assert (steel.sections[0].start, steel.sections[0].end) == (0.1, 0.2)
    steel.grippers += (dlo.pin(at="50 cm", position=(0.5, 0.1, 0)),)
    assert [gripper.hold for gripper in steel.grippers] == ["clamp", "pin"]
    steel.loads = [dlo.load(at=0.5, force=(0, "-10 mN", 0))]
    for owner, name, value, expected in [
        (steel, "diameter", 0.003, 0.003),
        (steel, "inner_diameter", "1 mm", 0.001),
        (steel, "bending_stiffness", "0.5 N m^2", 0.5),
        (steel, "mass_per_length", "20 g/m", 0.02),
        (steel, "torsional_stiffness", 0.3, 0.3),
        (steel, "gravity", (0, 0, "-9.81 m/s^2"), [0, 0, -9.81]),
        (steel.grippers[0], "position", numpy.array([0, 0.1, 0]), [0, 0.1, 0]),
        (steel.loads[0], "force", (0, 0, 1), [0, 0, 1]),
        (dlo.Gripper(at=0), "cutoff", "5 Hz", 5),
        (steel.force_model, "points", 32, 32),
        (steel.force_model, "law", "hooke", "hooke"),
    ]:
        setattr(owner, name, value)
        read = getattr(owner, name)
        assert read == expected if isinstance(expected, str) else numpy.allclose(read, expected, rtol=1e-14), name
    assert steel.gamma == pytest.approx(0.02 * 9.81 * 0.5**3 / 0.5, rel=1e-14)
    steel.bending_stiffness = None
    steel.inner_diameter = None
    steel.material = {"youngs_modulus": "100 GPa", "density": 8000}
    assert (steel.youngs_modulus, steel.density) == (1e11, 8000)
    assert steel.bending_stiffness == pytest.approx(1e11 * math.pi * 0.003**4 / 64, rel=1e-14)
    steel.force_model = {"points": 24}
    assert steel.force_model.points == 24


def test_a_solved_shape_with_its_frames_is_a_rest_shape(tmp_path):
    clamp = dlo.clamp(at=0, position=(0, 0, 0), frame=numpy.eye(3).tolist())
    fields = dict(
        length=0.3, gravity=(0, 0, 0), bending_stiffness=(1e-3, 5e-3), mass_per_length=4e-3,
        grippers=[clamp],
    )
    helix = dlo.Scene(helix={"radius": 0.02, "pitch": 0.05}, **fields)
    coil = dlo.solve(helix, samples=81)
    frames = numpy.column_stack([coil.points, coil.d1])
    numpy.savetxt(tmp_path / "coil.csv", frames, delimiter=",", header="x,y,z,d1_x,d1_y,d1_z", comments="")
    for rest_shape in (frames, frames.tolist(), str(tmp_path / "coil.csv")):
        again = dlo.Scene(rest_shape=rest_shape, **fields)
        assert again.rest_shape_error < 1e-9 and again.rest_shape_angle < 1e-7
        numpy.testing.assert_allclose(dlo.solve(again, samples=81).d1, coil.d1, atol=1e-7)
    assert math.isnan(helix.rest_shape_angle) and math.isnan(helix.rest_shape_error)
    bare = dlo.Scene(rest_shape=coil.points, **fields)
    assert math.isnan(bare.rest_shape_angle)
    # Without frames the coil is where its clamp's frame turns it.
    chord = numpy.linalg.norm(dlo.solve(bare, samples=2).points[-1])
    assert abs(chord - numpy.linalg.norm(coil.points[-1])) < 4 * bare.rest_shape_error < 1e-4
    refuses("given besides helix", bare.replace, helix={"radius": 1, "pitch": 1})


def test_a_helix_and_a_cable_are_keys_of_the_rod():
    spring = dlo.Scene(
        length=0.3, bending_stiffness=1e-3, mass_per_length=4e-3,
        helix={"radius": "2 cm", "pitch": "1 cm"},
        grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
    )
    assert spring.helix == {"radius": "2 cm", "pitch": "1 cm"}
    with pytest.raises(dlo.InputError, match="helix.radius") as wrong:
        spring.helix = {"radius": -1, "pitch": 0}
    assert wrong.value.key == "rod.helix.radius"
    strands = [{"strands": n, "strand_diameter": "1 mm", "material": "copper"} for n in (1, 6)]
    cable = dlo.Scene(length=0.3, layers=strands, grippers=spring.grippers)
    cable.layer_bound = "free"
    assert cable.layer_bound == "free" and cable.diameter == pytest.approx(3e-3)
    cable.force_model = {"joint_law": "linear"}
    assert cable.force_model.joint_law == "linear"


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
    refuses(r"inch\.toml:3: rod\.length = '30 inch'", dlo.Scene.from_file, path)
    refuses("missing.toml", dlo.solve, tmp_path / "missing.toml")


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
            refuses(rf"{key}.*nested too deep \(allowed: 32 levels", cable.replace, **{key: value})
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
        ("\ud800", r"gravity: text with an unpaired surrogate \(allowed: Unicode"),
        (2**64, r"gravity: an integer out of range \(allowed: up to 64 bits"),
        ({1: 2}, r"gravity: a key that is a int \(allowed: text"),
        ((x for x in "abc"), r"gravity: a generator \(allowed: a number, text"),
        (1j, r"gravity: a complex \(allowed: a number, text"),
    ]:
        with pytest.raises(dlo.InputError, match=words):
            cable.gravity = value


@pytest.mark.parametrize(
    "write, words",
    [
        (lambda s: setattr(s, "lenght", 2), r"a dlo.Scene has no lenght, did you mean length\?"),
        (
            lambda s: setattr(s.grippers[0], "postion", (0, 0, 0)),
            r"a dlo.Gripper has no postion, did you mean position\? \(allowed: at, ",
        ),
        (lambda s: setattr(s.force_model, "pionts", 9), r"ForceModelSettings has no pionts, did you mean poin"),
        (lambda s: setattr(s.track, "frame_rat", 9), r"TrackRates has no frame_rat, did you mean frame_rate\?"),
        (lambda s: setattr(s, "copy", 3), r"a dlo.Scene has no copy"),
        (lambda s: setattr(s, "gamma", 3), r"gamma of a dlo.Scene is derived"),
    ],
)
def test_what_nobody_reads_cannot_be_set(steel, write, words):
    before = steel.to_toml()
    with pytest.raises(AttributeError, match=words):
        write(steel)
    assert steel.to_toml() == before


@pytest.mark.parametrize(
    "write, key",
    [
        (lambda s: setattr(s, "force_model", {"pionts": 20}), "force_model.pionts"),
        (lambda s: setattr(s, "track", {"framerate": 20}), "track.framerate"),
        (lambda s: setattr(s, "material", {"youngs_moduls": 1e9}), "rod.material.youngs_moduls"),
        (lambda s: dlo.Gripper(at=0, postion=(0, 0, 0)), "gripper.postion"),
        (lambda s: dlo.Load(att=0), "load.att"),
        (lambda s: setattr(s, "grippers", [dlo.Gripper(at=0, pose=[{"tme": 0}])]), "gripper.pose.tme"),
    ],
)
def test_unknown_keys_of_tables_are_input_errors(steel, write, key):
    with pytest.raises(dlo.InputError, match=r"unknown key, did you mean \w+\?") as caught:
        write(steel)
    assert caught.value.key == key


def test_what_would_be_lost_cannot_be_written(steel):
    steel.material = {"youngs_modulus": "100 GPa", "density": 8000}
    for write in (
        lambda: steel.material.update(density=1),
        lambda: steel.material.__setitem__("density", 1),
        lambda: steel.material.pop("density"),
    ):
        with pytest.raises(TypeError, match="a copy of what the scene has"):
            write()
    other = steel.replace(length=1)
    other.material = steel.material
    assert other.material == {"youngs_modulus": "100 GPa", "density": 8000}
    assert pickle.loads(pickle.dumps(other.material)) == other.material


def test_every_key_of_a_scene_file_has_a_field(steel):
    python = {"from": "start", "to": "end"}
    kinds = [dlo.Gripper, dlo.Load, dlo.DistributedLoad, dlo.Obstacle, dlo.Section]
    kinds += [dlo.ForceModelSettings, dlo.Medium, dlo.TrackRates]
    for kind in kinds:
        fields = {key for key in dir(kind) if isinstance(getattr(kind, key), property)}
        assert fields == {python.get(key, key) for key in dlo._dlo.scene_keys[kind._name]}
    for key in dlo._dlo.scene_keys["rod"]:
        assert isinstance(getattr(dlo.Scene, key), property)


def test_a_key_that_is_not_given_has_its_default_or_none(steel):
    settings, gripper = steel.force_model, steel.grippers[0]
    assert (settings.points, settings.law, settings.joint_law, settings.c_c) == (16, "hooke", None, None)
    assert (steel.track.frame_rate, steel.track.start) == (1000, None)
    assert (gripper.hold, gripper.turns, gripper.roll, gripper.pose) == ("clamp", 0, None, None)
    assert dlo.load(at=0, mass=1).follows is False and dlo.distributed_load((0, 1, 0)).start == 0
    assert (steel.layer_bound, steel.natural_curvature, steel.torsional_stiffness) == ("bonded", None, None)
    assert dlo.clamp(0, (0, 0, 0), trajectory="path.csv").trajectory == "path.csv"


def test_loads_are_read_and_set_in_si_units(steel):
    scene = steel.replace(
        loads=[dlo.load(at="10 cm", torque=[0, 0, "2 mN m"])],
        distributed_loads=[dlo.distributed_load([[0, 1, 0], [0, "2 mN/m", 0]], start="10 cm")],
        medium={"density": "1 g/cm^3"},
    )
    assert scene.loads[0].force is None and scene.loads[0].torque[2] == 0.002
    (load,) = scene.distributed_loads
    assert load.start == 0.1 and load.end is None
    assert load.force_per_length.tolist() == [[0, 1, 0], [0, 0.002, 0]]
    assert scene.medium.density == 1000
    again = dlo.Scene.from_text(scene.to_toml())
    assert again.to_toml() == scene.to_toml()
    again.gravity = (0, 0, 0)
    assert again.medium.density == 1000 and len(again.distributed_loads) == 1
    with pytest.raises(dlo.InputError, match="load.torque.*out of a plane.*--model exact"):
        scene.loads[0].torque = (0, 1, 0)
        dlo.solve(scene)
    with pytest.raises(dlo.InputError, match="to > from"):
        load.end = 0.05


def test_loads_and_media_without_potential_are_fields(steel):
    scene = steel.replace(
        loads=[dlo.load(at=steel.length, force=["1 mN", 0, 0], follows=True)],
        medium={"density": 1.2, "velocity": [0, 0, "36 km/h"], "normal_drag": 1.2},
    )
    assert scene.loads[0].follows is True and scene.medium.velocity.tolist() == [0, 0, 10]
    scene.medium = None
    shape = dlo.solve(scene, model="exact")
    assert shape.status == "not_verified" and "stability is not judged" in shape.message


MOVING = """
rod = {length = 1, diameter = 0.01, material = "silicone"}
gripper = [{at = 0, direction = "0 deg", pose = [{time = 0, position = [0, 0, 0]}, {time = 1, position = [0, 0.5, 0]}]}]
track = {frame_rate = 20, step_rate = 900}
"""


def test_how_a_scene_is_tracked_survives_its_changes():
    scene = dlo.Scene.from_text(MOVING)
    scene.gravity = (0, -1, 0)
    for one in (scene, scene.copy(), scene.replace(length="90 cm"), pickle.loads(pickle.dumps(scene))):
        assert (one.track.frame_rate, one.track.obstacle_rate, one.track.step_rate) == (20, None, 900)
        assert "frame_rate" in one.to_toml()
    scene.track.frame_rate = 4
    assert dlo.track(scene, force=False).time.tolist() == [0, 0.25, 0.5, 0.75, 1]
    with pytest.raises(dlo.InputError, match="track.frame_rate = -1"):
        scene.track.frame_rate = -1
    scene.track = None
    assert scene.track.frame_rate == 1000
    assert dlo.Scene.from_text(MOVING).grippers[0].pose[1]["position"] == (0, 0.5, 0)


def test_a_scene_that_moves_is_taken_as_it_is_at_a_time(cable):
    scene = dlo.Scene.from_text(MOVING)
    for time, height in ((None, 0), (1.0, 0.5), (9, 0.5)):
        solution = dlo.solve(scene, samples=3, time=time)
        assert solution.points[0, 1] == height
        assert dlo.solve_all(scene, samples=3, time=time)[0].points[0, 1] == height
    assert dlo.compare(scene, modulus=False, time=1).energy_points[0, 1] == 0.5
    assert dlo.plan(scene, time=1)["geometry"] == "planar"
    assert dlo.modes(scene, count=1, samples=3, time=1).frequencies.shape == (1,)
    refuses(r"time = 1: nothing moves \(allowed: None", dlo.solve, cable, time=1)
    refuses(r"time = '1 s': a str \(allowed: a number", dlo.solve, scene, time="1 s")


def test_names_of_materials_are_those_of_a_file(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        '[[material]]\nname = "silicone"\nyoungs_modulus = "7 MPa"\ndensity = 1000\nsource = "me"\n'
        '[[material]]\nname = "goo"\nyoungs_modulus = "1 MPa"\ndensity = 900\nsource = "me"\n'
    )
    assert [one["name"] for one in dlo.materials(file)] == ["silicone", "goo"]
    path = tmp_path / "scene.toml"
    path.write_text(MOVING)
    read = dlo.Scene.from_file(path, materials=file)
    built = dlo.Scene(1, diameter=0.01, material="goo", grippers=[dlo.clamp(0, (0, 0, 0), 0)], materials=file)
    assert (read.youngs_modulus, built.youngs_modulus) == (7e6, 1e6)
    read.material = "goo"
    for one in (read, read.copy(), pickle.loads(pickle.dumps(read)), read.replace(length=2)):
        assert one.youngs_modulus == 1e6
    table = dlo.sweep(path, {"rod.material": ["goo", "silicone"]}, materials=file)
    tip = dlo.solve(path, samples=2, materials=file).points[1, 1]
    assert table["tip_y_m"][1] == pytest.approx(tip, rel=1e-12)
    refuses("none.toml", dlo.solve, read, materials=tmp_path / "none.toml")
    refuses(r"materials: a int \(allowed: the name of a file", dlo.solve, path, materials=3)


def test_a_line_that_stretches():
    line = dlo.Scene(
        length=100, bending_stiffness=200, mass_per_length=2, axial_stiffness="400 kN", gravity=(0, 0, -9.81),
        grippers=[dlo.pin(at=0, position=(0, 0, 0)), dlo.pin(at=100, position=(98, 0, 0))],
    )
    assert line.axial_stiffness == 400000 and line.stretch is False
    without = dlo.solve(line)
    assert "stretch" in without.neglected and without.stretch_strain > 0.007
    assert without.stretch_decision == "given"
    for stretch in (True, "auto"):
        line.stretch = stretch
        assert line.stretch == dlo.Scene.from_text(line.to_toml()).stretch == stretch
        stretched = dlo.solve(line, model="exact")
        assert stretched.neglected == [] and stretched.energy["stretch"] > 0
    assert stretched.stretch_decision == stretched.json["stretch_decision"] == "counted"
    assert dlo.solve(line, model="energy").stretch_decision == "not_modelled"
    with pytest.raises(dlo.InputError, match='allowed: true, false or "auto"'):
        line.stretch = "yes"
