"""A recording comes back from the results file as it was put in."""

import sqlite3
from dataclasses import fields, replace

import numpy as np
import pytest

from harness.errors import InputError
from harness.store.database import Database
from harness.store.recording import NearLines, RecordedMesh, Recording, recording_of
from harness.store.records import PointRow

TRIANGLE = RecordedMesh(
    "triangle", "abc", np.array([[0.5, 0, 0], [-0.25, 0.4, 0], [-0.25, -0.4, 0.1]]), np.array([[0, 1, 2]], np.int32)
)

SQUARE = RecordedMesh(
    "square",
    "def",
    np.array([[0.3, 0.3, 0], [-0.3, 0.3, 0], [-0.3, -0.3, 0], [0.3, -0.3, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)


def recording(surfaces=(TRIANGLE,), bodies=3):
    rng = np.random.default_rng(bodies)
    turned = np.array([0.0, 2.0][: min(bodies, 2)], float)
    return Recording(
        shape="mesh" if surfaces else "sphere", duration=1.5, dt=0.1, half_box=np.array([1.0, 2.0, 1 / 3]),
        sizes=rng.random(bodies), quaternions=rng.random((bodies, 4)), spins=rng.random((bodies, 3)),
        surfaces=surfaces, surface_of=np.arange(bodies) % max(1, len(surfaces)),
        leg_times=np.r_[np.zeros(bodies), np.full(len(turned), 0.7), 0.9],
        leg_bodies=np.r_[np.arange(bodies), turned, 1].astype(int),
        leg_positions=rng.random((bodies + len(turned) + 1, 3)),
        leg_velocities=rng.random((bodies + len(turned) + 1, 3)),
        hit_times=np.array([0.7, 0.9]), hit_bodies=np.array([[0, 2], [1, -1]]), hit_walls=np.array([-1, 3]),
    )  # fmt: skip


def kept(path, *recordings):
    """Each recording with a point of its own, all of one experiment."""
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"fingerprint": "m"}, {})
        points = [PointRow(f"key-{place}", {"count": place}) for place in range(len(recordings))]
        database.list_experiment(sweep, "x", "X", None, "", {}, points)
        for point, found in zip(points, recordings, strict=True):
            database.add_run(sweep, point.key, 0, "ok", None, None, {"pair_hits": (1.0, "1")}, True)
            database.add_recording(point.key, found)
        assert database.recorded(["key-0", "missing"]) == {"key-0"}


def same(a, b):
    for field in fields(Recording):
        one, other = getattr(a, field.name), getattr(b, field.name)
        if field.name == "surfaces":
            assert [mesh.digest for mesh in one] == [mesh.digest for mesh in other]
            assert all((a.vertices == b.vertices).all() for a, b in zip(one, other, strict=True))
            assert all((a.faces == b.faces).all() for a, b in zip(one, other, strict=True))
        elif field.name == "near":
            assert (one is None) == (other is None)
            assert one is None or all(np.array_equal(mine, theirs) for mine, theirs in zip(one, other, strict=True))
        else:
            assert np.array_equal(one, other, equal_nan=field.name == "hit_points" and one is not None), field.name


def test_what_other_queries_add_comes_back_to_the_bit(tmp_path):
    rng = np.random.default_rng(2)
    near = NearLines(np.array([1, 1, 4]), np.array([[0, 1], [0, 2], [1, 2]]), rng.random((3, 2, 3)))
    made = replace(recording(), near=near, hit_points=np.array([[0.1, 0.2, 1 / 3], [np.nan] * 3]))
    kept(tmp_path / "r.db", made)
    same(recording_of(tmp_path / "r.db", "x").recording, made)


def test_what_was_recorded_comes_back_to_the_bit(tmp_path):
    kept(tmp_path / "r.db", recording())
    found = recording_of(tmp_path / "r.db", "x")
    same(found.recording, recording())
    assert found.parameters == {"count": 0}
    assert found.counters == {"pair_hits": 1.0}


def test_the_newest_recording_is_shown_and_a_mesh_is_kept_once(tmp_path):
    kept(tmp_path / "r.db", recording(bodies=5), recording())
    same(recording_of(tmp_path / "r.db", "x").recording, recording())


def test_spheres_need_no_mesh(tmp_path):
    kept(tmp_path / "r.db", recording(()))
    same(recording_of(tmp_path / "r.db", "x").recording, recording(()))


def test_a_mixture_keeps_every_mesh_and_which_body_has_which(tmp_path):
    kept(tmp_path / "r.db", recording((TRIANGLE, SQUARE), bodies=4))
    same(recording_of(tmp_path / "r.db", "x").recording, recording((TRIANGLE, SQUARE), bodies=4))


def test_an_experiment_without_a_recording_has_none(tmp_path):
    kept(tmp_path / "r.db", recording())
    assert recording_of(tmp_path / "r.db", "y") is None


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE recording SET facts = '{}'",
        "UPDATE recording SET bodies = zeroblob(100)",
        "UPDATE frame SET data = x'00'",
        "DELETE FROM frame",
    ],
)
def test_a_recording_that_is_damaged_is_said(tmp_path, change):
    kept(tmp_path / "r.db", recording())
    with sqlite3.connect(tmp_path / "r.db") as raw:
        raw.execute(change)
    with pytest.raises(InputError, match="is damaged: the recording of run 1 cannot be read"):
        recording_of(tmp_path / "r.db", "x")


def test_a_counter_that_was_measured_and_is_no_number_is_not_among_those_of_a_recording(tmp_path):
    kept(tmp_path / "r.db", recording())
    with sqlite3.connect(tmp_path / "r.db") as raw:
        raw.execute("UPDATE metric SET value = NULL")
    assert recording_of(tmp_path / "r.db", "x").counters == {}
