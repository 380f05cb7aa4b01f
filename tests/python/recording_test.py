"""Recordings in NumPy's archives: t, points, and where they are known s."""

import json
import os
import pathlib
import subprocess

import numpy
import pytest

import dlo


@pytest.fixture(scope="module")
def swung():
    return pathlib.Path(os.environ["DLO_ROOT"]) / "data/scenes/swung_rod.toml"


@pytest.fixture(scope="module")
def track(swung):
    return dlo.track(swung, end=0.1, frame_rate=50, force=False, samples=9)


def rows_of(track):
    frames = zip(track.time, track.points)
    return [[t, s, *point] for t, points in frames for s, point in zip(track.arc_length, points)]


def told(check):
    """But for the name of what was checked."""
    return {key: value for key, value in check.json.items() if key not in ("motion", "file", "recording")}


@pytest.mark.parametrize("save", [numpy.savez, numpy.savez_compressed])
def test_an_archive_is_the_same_as_its_rows(swung, track, tmp_path, save):
    save(tmp_path / "rod.npz", t=track.time, points=track.points, s=track.arc_length, other=numpy.eye(2))
    found = dlo.check(swung, motion=tmp_path / "rod.npz")
    expected = dlo.check(swung, motion=rows_of(track))
    assert told(found) == told(expected)
    assert found.rms < 1e-6 and len(found.time) == len(track.time)


def test_orders_of_axes_and_of_times_do_not_matter(swung, track, tmp_path):
    order = numpy.random.default_rng(1).permutation(len(track.time))
    numpy.savez(tmp_path / "a.npz", t=track.time[order].astype(">f8"), s=track.arc_length[::-1],
                points=numpy.asfortranarray(track.points[order][:, ::-1]))
    assert told(dlo.check(swung, motion=tmp_path / "a.npz")) == told(dlo.check(swung, motion=rows_of(track)))


def test_without_arc_lengths_points_lie_along_their_polylines(swung, track, tmp_path):
    """Chords are shorter than arcs by (kappa h)^2 / 24 of themselves, h the length between points."""
    numpy.savez(tmp_path / "rod.npz", t=track.time, points=track.points)
    check = dlo.check(swung, motion=tmp_path / "rod.npz")
    h = track.arc_length[1]
    curvature = max(dlo.solve(swung, time=t).curvature.max() for t in track.time)
    assert check.rms <= track.arc_length[-1] * (curvature * h) ** 2 / 24 + 1e-6


def test_two_coordinates_are_in_the_plane(swung, track, tmp_path):
    assert not track.points[:, :, 2].any()
    numpy.savez(tmp_path / "plane.npz", t=track.time, points=track.points[:, :, :2], s=track.arc_length)
    assert dlo.check(swung, motion=tmp_path / "plane.npz").rms < 1e-6


def test_the_command_reads_them_too(swung, track, tmp_path, command):
    numpy.savez(tmp_path / "rod.npz", t=track.time, points=track.points, s=track.arc_length)
    done = subprocess.run(
        [command, "check", str(swung), "--motion", str(tmp_path / "rod.npz"), "--format", "json"],
        capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == dlo.check(swung, motion=tmp_path / "rod.npz").json


def test_bad_archives_are_told_in_one_line_that_names_file_and_array(swung, track, tmp_path):
    t, points, s = track.time, track.points, track.arc_length
    bent = points.copy()
    bent[2, 4, 1] = numpy.nan
    still = points.copy()
    still[3, 5] = still[3, 4]
    bad = {
        'no array t, but "time", "points" .allowed: t, T times in s': {"time": t, "points": points},
        'no array points, but "t", "x"': {"t": t, "x": points},
        "array t: an array of 1 x 6 .allowed: a row of times": {"t": t[None], "points": points},
        "array t: number 1 is nan": {"t": numpy.where(t == t[1], numpy.nan, t), "points": points},
        "array t: numbers of the type": {"t": t.astype(str), "points": points},
        "array points: an array of 6 x 9 x 3 where array t has 5": {"t": t[1:], "points": points},
        "array points: an array of 9 x 3 where array t has 6": {"t": t, "points": points[0]},
        "array points: an array of 6 x 9 x 1 where": {"t": t, "points": points[:, :, :1]},
        "array points: an array of 0 x 9 x 3 where": {"t": t[:0], "points": points[:0]},
        "array s: an array of 8 .allowed: as many numbers as a frame": {"t": t, "points": points, "s": s[1:]},
        "array s: number 2 is inf": {"t": t, "points": points, "s": numpy.where(s == s[2], numpy.inf, s)},
        r"points\[2\]: point 5: y = nan .allowed": {"t": t, "points": bent},
        r"points\[3\]: point 6: the same as the point before": {"t": t, "points": still},
        r"points\[0\]: 1 point .allowed: 2 to": {"t": t, "points": points[:, :1]},
        r"points\[0\] and points\[1\] are both at 0 s": {"t": 0 * t, "points": points},
    }
    for words, arrays in bad.items():
        numpy.savez(tmp_path / "bad.npz", **arrays)
        with pytest.raises(dlo.InputError, match="bad.npz.*" + words) as refused:
            dlo.check(swung, motion=tmp_path / "bad.npz")
        assert "\n" not in str(refused.value)
    numpy.save(tmp_path / "bad.npy", points)
    with pytest.raises(dlo.InputError, match="bad.npy: one array, without times .allowed: FILE.npz"):
        dlo.check(swung, motion=tmp_path / "bad.npy")


def test_an_archive_that_is_cut_off_is_refused_wherever_it_is(swung, track, tmp_path):
    numpy.savez(tmp_path / "rod.npz", t=track.time[:2], points=track.points[:2, :3])
    whole = (tmp_path / "rod.npz").read_bytes()
    for length in range(4, len(whole), 7):
        (tmp_path / "cut.npz").write_bytes(whole[:length])
        with pytest.raises(dlo.InputError, match="cut.npz: ") as refused:
            dlo.check(swung, motion=tmp_path / "cut.npz")
        assert "\n" not in str(refused.value)
