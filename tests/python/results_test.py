"""Tests of results: arrays that are views, and the command's own documents."""

import contextlib
import copy
import gc
import json
import math
import pickle
import subprocess
import tomllib

import numpy
import pytest
from conftest import refuses, without_times

import dlo


def test_solve_is_the_commands(root, command_json):
    scene = root / "data/scenes/spring_steel_175.toml"
    solution = dlo.solve(scene, samples=9)
    assert without_times(solution.json) == command_json("solve", scene, "--samples", 9)
    assert json.loads(solution.to_json())["schema"] == "dlo/solve/1"
    assert "energy, converged" in str(solution)


def test_solve_takes_points_or_the_number_of_an_equilibrium(tmp_path):
    scene = dlo.Scene(
        length="1 m", diameter="6 mm", bending_stiffness="5e-3 N m^2", mass_per_length="0.06 kg/m",
        grippers=[dlo.pin(at=0, position=(-0.35, 0.06, 0))],
        loads=[dlo.load(at="1 m", mass="1.5 kg")],
        obstacles=[dlo.obstacle(shape="cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius="4 cm")],
    )
    over = [[-0.35, 0.06], [-0.01, 0.043], [0.03, 0.03], [0.043, 0], [0.043, -0.3], [0.043, -0.59]]
    file = tmp_path / "over.csv"
    numpy.savetxt(file, over, delimiter=",")
    near = dlo.solve(scene, near=over)
    assert numpy.allclose(dlo.solve(scene, near=file).points, near.points)
    assert abs(dlo.solve(scene, equilibrium=2).energy["total"] - near.energy["total"]) < 1e-9
    lowest = dlo.solve(scene)
    assert lowest.stable_energies == [lowest.energy["total"]] and lowest.passing_starts == 2
    refuses("only model energy", dlo.solve, scene, "exact", near=over)
    assert dlo.check(scene, near.points, explain=False).energy_above_lowest > 0.1


def test_check_has_the_deflection_and_the_frame_that_it_found(cable):
    points = numpy.array(dlo.solve(cable, samples=15).points) @ numpy.diag((-1, 1, -1)) + (1, 2, 3)
    options = {"tolerance": "5% of deflection", "modulus": False, "explain": False, "measure": "max"}
    assert dlo.check(cable, points, **options).passed is False
    found = dlo.check(cable, points, register="upright", **options)
    assert found.passed and found.verdict == "pass" and found.significant is True
    assert found.json["tolerance"]["allowed_m"] == pytest.approx(0.05 * found.deflection)
    assert found.json["tolerance"]["measure"] == "max"
    assert dlo.check(cable, points, min_seen=0.2, explain=False).json["tolerance"]["least_seen_share"] == 0.2


def test_check_is_the_commands(root, command_json):
    scene = root / "data/scenes/cable.toml"
    shape = root / "data/shapes/cable.csv"
    points = numpy.loadtxt(shape, delimiter=",", skiprows=3)
    check = dlo.check(scene, points, tolerance="1%")
    expected = command_json("check", scene, "--shape", shape, "--tolerance", "1%", "--arc-lengths", "nearest")
    document = check.json
    assert document.pop("shape") == "points"
    expected.pop("shape")
    assert document == expected
    assert check.passed == (expected["verdict"] == "pass")


def test_deviations_are_those_of_the_document(steel):
    steel.force_model = {"points": 12}
    comparison = dlo.compare(steel, modulus=False)
    check = dlo.check(steel, dlo.solve(steel, model="chain").points, modulus=False)
    for result, document in ((comparison, comparison.json["cases"][0]), (check, check.json)):
        for name, value in result.deviation.items():
            told = document["deviation"][name]
            assert numpy.isnan(value) if told is None else value == told, name
        assert 0 < result.deviation["rms_m"] < result.deviation["max_m"]


def test_compare_is_the_commands(root, command_json):
    file = root / "data/scenes/spring_steel_175.toml"
    scene = dlo.Scene.from_file(file)
    scene.force_model = {"points": 16, "law": "hooke", "bookkeeping": "consistent"}
    comparison = dlo.compare(scene)
    expected = command_json("compare", file, "--law", "hooke", "--bookkeeping", "consistent")
    assert comparison.json["schema"] == expected["schema"]
    assert comparison.deviation["rms_m"] == expected["cases"][0]["deviation"]["rms_m"]
    assert comparison.force_points.shape == comparison.energy_points.shape == (16, 3)


def test_arrays_are_views_that_keep_the_result_alive(cable):
    solution = dlo.solve(cable, samples=33)
    points, s = solution.points, solution.arc_length
    assert points.shape == (33, 3) and s.shape == (33,)
    assert points.flags.c_contiguous and not points.flags.owndata and not points.flags.writeable
    assert points.ctypes.data == solution.points.ctypes.data
    with pytest.raises(ValueError):
        points[0, 0] = 1
    del solution
    # Chords of 1/32 m are shorter than their arcs, most where the rod bends at the clamp.
    assert 0.99 < numpy.linalg.norm(numpy.diff(points, axis=0), axis=1).sum() < 1
    assert s[-1] == 1


def test_every_view_outlives_its_result(root, steel, cable):
    cable.obstacles = [dlo.obstacle(point=(0, -0.5, 0), normal=(0, 1, 0))]
    results = {
        "of all grippers": dlo.solve(root / "data/scenes/twisted_wire.toml", samples=9),
        "with a floor": dlo.solve(cable, samples=9),
        "loop": dlo.ForceModel(steel),
    }
    seen = set()
    while results:
        what, result = results.popitem()
        found = {name: getattr(result, name) for name in dir(result)
                 if name[0] != "_" and name != "json"}
        views = {name: view for name, view in found.items()
                 if isinstance(view, numpy.ndarray) and view.size > 0}
        assert views and not any(view.flags.owndata for view in views.values())
        before = {name: view.copy() for name, view in views.items()}
        seen |= set(views)
        del result, found
        gc.collect()
        for name, view in views.items():
            # The sanitizer sees what is copied as a whole; what is copied number by number would be what
            # it fills freed memory with.
            view.tobytes()
            numpy.testing.assert_array_equal(view, before[name], err_msg=f"{what}: {name}")
    assert seen >= {"points", "curvature", "tension", "d1", "gripper_forces", "gripper_torques",
                    "obstacle_forces", "arc_length"}


def test_grippers_bear_the_weight(cable):
    solution = dlo.solve(cable)
    weight = -cable.mass * cable.gravity
    numpy.testing.assert_allclose(solution.gripper_forces, [weight], atol=1e-9 * weight[1])
    assert solution.gripper_torques.tolist() == [one["torque_Nm"] for one in solution.json["grippers"]]
    assert solution.tension.shape == solution.curvature.shape == solution.arc_length.shape


def test_each_simulator_makes_the_same_joint_of_its_parameter(root):
    """A joint's stiffness follows from each parameter by its unit; a capsule has the mass of its segment."""
    numbers = {"k": 0.2, "k_b": 0.19, "h": 0.05, "r": 0.004, "m": 0.06, "pi": math.pi}
    k, k_b, h, r, m, pi = numbers.values()
    joint = {"N m/rad": 1, "N m/deg": 180 / pi, "N m^2": 1 / h, "Pa": pi * r**4 / 4 / h}
    with open(root / "data/simulators.toml", "rb") as file:
        parameters = tomllib.load(file)["parameters"]
    assert len({(each["program"], each["version"], each["name"]) for each in parameters}) == 14
    for each in parameters:
        value = eval(each["formula"], {}, numbers)
        if each["unit"] == "kg/m^3":
            assert value * pi * (r**2 * h + 4 / 3 * r**3) == pytest.approx(m * h)
        else:
            assert value * joint[each["unit"]] == pytest.approx(k_b if "k_b" in each["formula"] else k), each


def test_calibrate_gives_each_joint_of_unequal_segments_its_spring(cable):
    points = dlo.solve(cable, model="exact", samples=15).points
    lengths = cable.length * numpy.array([0.05, 0.07, 0.1, 0.18, 0.25, 0.35])
    chains = dlo.calibrate(cable, [points], segment_lengths=lengths)["chains"]
    welded = chains[1]
    assert welded["clamp"] == "welded" and [joint["at_m"] for joint in welded["joints"]] == pytest.approx(
        numpy.cumsum(lengths)[:-1], abs=0.02 * cable.length)
    found = [joint["joint_stiffness_Nm_per_rad"] for joint in welded["joints"]]
    EI = welded["over_bending_stiffness_per_length"] * cable.bending_stiffness
    assert found == pytest.approx(2 * EI / (lengths[:-1] + lengths[1:]), rel=1e-3)
    refuses("a chain of 3 segments", dlo.calibrate, cable, [points], segment_lengths=[0.3, 0.3, 0.4])
    refuses(r"a str \(allowed: a list of numbers\)", dlo.calibrate, cable, [points], segment_lengths=["1 cm"])


def test_a_fit_of_a_stiffness_is_no_modulus(cable):
    wire = dlo.Scene(
        length=1,
        bending_stiffness=cable.bending_stiffness,
        mass_per_length=cable.mass,
        grippers=cable.grippers,
    )
    points = dlo.solve(wire, model="exact", samples=15).points
    fit = dlo.calibrate(wire, [points])
    assert fit.youngs_modulus is None
    assert fit.bending_stiffness == pytest.approx(cable.bending_stiffness, rel=1e-3)
    assert fit.interval[0] <= fit.bending_stiffness <= fit.interval[1]
    assert dlo.calibrate(cable, [points]).bending_stiffness is None


def test_two_points_are_points(cable):
    tip = dlo.solve(cable, samples=2).points
    for two in (tip.tolist(), tuple(map(tuple, tip)), tip[:, :2].tolist(), tuple(tip)):
        assert len(dlo.check(cable, two, modulus=False).points) == 2
        fit = dlo.calibrate(cable, [two, two])
        assert len(fit["shapes"][0]["points_m"]) == 2
    s = dlo.solve(cable, samples=3).arc_length
    pair = (dlo.solve(cable, samples=3).points, s)
    assert len(dlo.calibrate(cable, [pair])["shapes"][0]["points_m"]) == 3


def test_a_shape_may_be_the_name_of_a_file_and_one_needs_no_list(root, cable, command_json):
    scene, shape = root / "data/scenes/cable.toml", root / "data/shapes/cable.csv"
    for name in (shape, str(shape)):
        found = dlo.check(scene, name, tolerance="1%").json
        assert found == command_json("check", scene, "--shape", shape, "--tolerance", "1%")
    points = numpy.loadtxt(shape, delimiter=",", skiprows=3)
    pair = (points, numpy.linspace(0.1, 1, len(points)))
    for one, listed in ((shape, [points]), (points, [points]), (points.tolist(), [shape]), (pair, [pair])):
        assert len({dlo.calibrate(scene, shapes, time_limit=1000).youngs_modulus for shapes in (one, listed)}) == 1
    assert len(dlo.calibrate(scene, (points, points + 1e-4), time_limit=1000)["shapes"]) == 2
    # A fit whose alternatives take too long has no result: these widen the interval.
    for limit in (0.01, 0.04, 0.16, 0.64, 2.56):
        with contextlib.suppress(dlo.ConvergenceError):
            assert dlo.calibrate(scene, pair, time_limit=limit).youngs_modulus is None
    for call, words in [
        (lambda: dlo.check(cable, shape, arc_length=[0, 1]), "arc_length: given besides the name of a file"),
        (lambda: dlo.check(cable, "none.csv"), "none.csv"),
        (lambda: dlo.check(cable, points, arc_length="s.csv"), r"arc_length: the name of a file \(allowed: an arr"),
        (lambda: dlo.ForceModel(cable, shape), r"points: the name of a file .*numpy.loadtxt\(.*cable.csv"),
    ]:
        refuses(words, call)


def test_calibrate_gives_parameters_that_a_scene_takes(steel):
    fit = dlo.calibrate(steel, target=1e-3)
    assert fit["reached"]
    names = ("law", "bookkeeping", "points", "c_c", "stepper", "c_F", "c_h", "l_s")
    steel.force_model = {name: fit.parameters[name] for name in names}
    assert dlo.compare(steel, modulus=False).deviation["rms_over_length"] <= 1e-3


def test_plan_and_modes(steel):
    assert dlo.plan(steel)["geometry"] == "planar"
    modes = dlo.modes(steel, count=2, samples=5)
    assert modes.shapes.shape == (2, 5, 3)
    assert modes.frequencies.tolist() == [mode["frequency_Hz"] for mode in modes.json["modes"]]


def test_sweep_has_the_rows_of_the_command(root, command):
    scene = root / "data/scenes/spring_steel_175.toml"
    columns = dlo.sweep(scene, {"gamma": [0.1, 1], "gripper.0.direction": ["-90 deg", "0 deg"]})
    done = subprocess.run(
        [command, "sweep", str(scene), "--vary", "gamma=0.1,1", "--vary",
         "gripper.0.direction=-90 deg,0 deg"],
        capture_output=True, text=True, check=True,
    )
    header, *rows = [line.split(",") for line in done.stdout.splitlines()]
    # The command writes the common unit of a list into the name of its column.
    assert list(columns) == [name.partition(" [")[0] for name in header]
    assert columns["row"].tolist() == [0, 1, 2, 3]
    for name in ("gamma", "tip_x_m", "tip_y_m", "energy_J", "terms"):
        # The command writes ten digits.
        assert [f"{value:.10g}" for value in columns[name]] == [row[header.index(name)] for row in rows]
    assert columns["status"].tolist() == ["ok"] * 4


def test_a_sweep_has_all_digits_and_the_types_it_says(cable):
    table = dlo.sweep(cable, {"rod.length": [1, 1 / 3], "gripper.0.direction": ["30 deg", 0.5]})
    assert table["rod.length"].tolist() == [1, 1, 1 / 3, 1 / 3]
    tip = dlo.solve(cable).points[-1]
    assert [table[f"tip_{axis}_m"][0] for axis in "xy"] == tip[:2].tolist()
    assert table["gripper.0.direction"].tolist() == ["30 deg", "0.5"] * 2
    kinds = {name: column.dtype.kind for name, column in table.items()}
    assert kinds.pop("row") == "i"
    assert kinds.pop("gripper.0.direction") == kinds.pop("status") == "U"
    assert set(kinds.values()) == {"f"}
    # The types do not depend on the rows. A row without result has an empty text or NaN.
    table = dlo.sweep(cable, {"rod.length": numpy.array([1, -1]), "force_model.points": [12]}, model="compare-chain")
    assert {name: table[name].dtype.kind for name in ("optimum", "evaluations", "tip_over_length")} == {
        "optimum": "U", "evaluations": "f", "tip_over_length": "f",
    }
    assert table["optimum"][1] == "" and numpy.isnan(table["evaluations"][1])
    assert table["status"][0] == "ok" and "rod.length" in table["status"][1]
    pinned = cable.replace(grippers=[*cable.grippers, dlo.pin(at=1, position=(0.6, 0, 0))])
    table = dlo.sweep(pinned, {"force_model.points": [12]}, model="compare-chain")
    assert numpy.isnan(table["tip_over_length"]).all()


def test_compare_plans_when_it_is_asked(steel):
    steel.force_model = {"points": 12}
    quick, planned = dlo.compare(steel, modulus=False), dlo.compare(steel, modulus=False, plan=True)
    assert "plan" not in quick.json["cases"][0] and planned.json["cases"][0]["plan"]["geometry"] == "planar"
    assert str(planned).startswith(str(dlo.plan(steel)))


def test_stability_and_bench(steel):
    table = dlo.stability(case="folded", steppers=["auto"], threads=1)
    assert table["cases"][0]["outcome"] == "pass"
    runs = dlo.bench(steel, seconds=1, repeats=1)["runs"]
    assert {run["model"] for run in runs} >= {"energy", "chain"}


def test_a_map_of_stability_is_the_commands(root, command_json):
    scene = root / "data/scenes/spring_steel_175.toml"
    table = dlo.stability(scene, map="cF-cc", columns=2, rows=3, map_steps=50)
    options = ("--map", "cF-cc", "--columns", 2, "--rows", 3, "--map-steps", 50)
    assert table.json == command_json("stability", scene, *options)
    refuses("allowed: cF-cc, cF-ch", dlo.stability, map="cF")


@pytest.fixture
def results(cable):
    return [dlo.solve(cable), dlo.solve_all(cable)[0]]


def test_documents_are_pickled_with_their_pictures(cable):
    for result in (dlo.check(cable, dlo.solve(cable).points), dlo.compare(cable, modulus=False), dlo.plan(cable)):
        again = pickle.loads(pickle.dumps(result))
        assert (type(again), str(again), again.json) == (type(result), str(result), result.json)
        if not isinstance(result, dlo.Plan):
            assert repr(again._panel(None)) == repr(result._panel(None))  # some numbers are NaN
            numpy.testing.assert_array_equal(again.arc_length, result.arc_length)


def test_results_are_copied_as_they_are_and_not_pickled(results, cable):
    for result in results:
        assert copy.copy(result) is result
        assert copy.deepcopy([result])[0] is result
    for one in results + [dlo.ForceModel(cable), dlo.Batch([cable]), cable._data]:
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            with pytest.raises(TypeError, match=rf"a dlo.{type(one).__name__} cannot be pickled"):
                pickle.dumps(one, protocol)
    for loop in [dlo.ForceModel(cable), dlo.Batch([cable])]:
        for function in (copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match=r"copied \(allowed: a new one of its scene"):
                function(loop)


def test_only_functions_make_results(results, cable):
    for one in results + [cable._data]:
        kind = type(one)
        for make in (kind, lambda: kind.__new__(kind), lambda: kind(3)):
            with pytest.raises(TypeError, match=r"not made by its class \(allowed: "):
                make()


def test_an_object_that_its_class_has_not_made_is_refused():
    for kind in (dlo.ForceModel, dlo.Batch):
        empty = kind.__new__(kind)
        for call in (empty.points, lambda: len(empty), empty.__reduce__):
            with pytest.raises(TypeError, match="not made by its class|no attribute|cannot be"):
                call()


def test_a_huge_array_is_refused_before_it_is_copied(cable):
    huge = numpy.broadcast_to(numpy.zeros(3, dtype="i1"), (10**9, 3))
    refuses("numbers .allowed: up to", dlo.check, cable, huge)
