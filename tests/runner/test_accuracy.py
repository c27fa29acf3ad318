"""Errors of runs against the reference that their experiment declares."""

import numpy as np
import pytest

from harness.experiment.load import load_text
from harness.runner import accuracy, reference_cache
from harness.runner.execute import execute
from harness.runner.key import point_key
from harness.scene.scene_files import SceneFiles

GAS = """
title: Gas
scene: {shape: sphere, count: 12, box: [4, 4, 4], speed: {uniform: [1, 3]}}
motion: {duration: 3, response: none}
engine: {algorithm: grid}
measure: {repeats: 1, reference: {algorithm: predictive, tolerance: 1.0e-10}}
"""


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return reference_cache


def points(text=GAS, **leaves):
    return load_text(text, "gas.yaml", leaves).points


def metrics(text=GAS, **leaves):
    (point,) = points(text, **leaves)
    return execute(point, SceneFiles()).metrics


@pytest.mark.slow
def test_frames_see_hits_late_by_up_to_a_frame_and_by_half_of_one_in_the_middle():
    for dt in (1 / 30, 1 / 300):
        found = metrics(dt=dt)
        assert found["reference_hits"] > 20
        assert 0.25 * dt < found["time_error"] < 0.75 * dt
        assert 0.75 * dt < found["time_error_95"] <= dt
        assert found["extra_hits"] == 0
    assert found["missed_hits"] == found["missed_hits_expected"] == 0


@pytest.mark.slow
def test_predictive_sees_every_hit_when_it_happens():
    found = metrics(algorithm="predictive")
    assert found["missed_hits"] == found["extra_hits"] == 0
    assert found["time_error_95"] < 1e-12
    assert found["reference_error"] < 1e-12
    assert "missed_hits_expected" not in found


@pytest.mark.parametrize("response", ["none", "elastic"])
def test_a_reference_ignores_the_pairs_that_its_scene_ignores(response):
    ignored = [[i, j] for i in range(12) for j in range(i + 1, 12) if (i + j) % 2]
    some = metrics(GAS.replace("speed", f"ignore: {ignored}, speed"), algorithm="predictive", response=response)
    every = metrics(algorithm="predictive", response=response)
    if response == "none":
        assert some["missed_hits"] == some["extra_hits"] == 0
        assert 0 < some["reference_hits"] < every["reference_hits"]
    else:
        assert some["divergence_time"] == 3
        assert 0 < some["pair_hits"] < every["pair_hits"]


@pytest.mark.slow
def test_a_fast_body_tunnels_as_often_as_its_contacts_are_shorter_than_a_frame():
    """One body flies through another at rest; each contact of length l is missed with probability 1 - l / dt."""
    crossing = """
title: Tunnelling
scene:
  shape: sphere
  bodies: [{position: [0, 0, 0]}, {position: [2, 0.3, 0.1], velocity: [97, 53, 31], size: 0.5}]
  box: [6, 5, 4]
motion: {duration: 600, response: none, dt: 1/60}
measure: {repeats: 1, reference: {}}
"""
    found = metrics(crossing)
    expected, hits = found["missed_hits_expected"], found["reference_hits"]
    assert 0.2 < expected < 0.6
    # a contact's own chance spreads less than the mean one would
    assert abs(found["missed_hits"] - expected) < 3 * np.sqrt(expected * (1 - expected) / hits)
    assert abs(found["missed_hits_deviation"]) < 3
    assert found["extra_hits"] == 0


@pytest.mark.slow
def test_in_free_flight_a_finer_step_follows_the_reference_longer():
    free = GAS.replace("none", "elastic")
    coarse, fine = metrics(free, dt=1 / 30), metrics(free, dt=1 / 30000, duration=1)
    assert 0 < coarse["divergence_time"] < 3
    assert 0 < fine["position_error"] < 0.01
    assert "time_error" not in fine
    own = metrics(free, algorithm="predictive")
    assert own["divergence_time"] == 3
    assert own["position_error"] == 0
    assert 0 < own["reference_position_error"] < 1e-9
    assert own["reference_divergence_time"] == 3


def test_a_reference_is_made_once_for_all_points_of_a_sweep(monkeypatch):
    made = []

    def counting(*arguments):
        made.append(arguments)
        return scene_contacts(*arguments)

    scene_contacts = accuracy.scene_contacts
    monkeypatch.setattr(accuracy, "scene_contacts", counting)
    for algorithm in ("grid", "tree"):
        for dt in (0.1, 0.01):
            metrics(algorithm=algorithm, dt=dt)
    assert len(made) == 1
    metrics(seed=1)
    assert len(made) == 2


def test_a_reference_that_cannot_be_kept_is_made_again(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert metrics()["extra_hits"] == 0


def test_a_damaged_or_unfinished_reference_is_made_again(cache):
    metrics()
    (kept,) = cache.folder().glob("*.npz")
    for content in (b"", b"PK", kept.read_bytes()[:100]):
        kept.write_bytes(content)
        assert metrics()["extra_hits"] == 0
    assert not list(cache.folder().glob("*.part"))


def test_a_point_with_a_reference_is_another_than_without_and_no_other_measures_errors():
    plain = GAS.replace(", reference: {algorithm: predictive, tolerance: 1.0e-10}", "")
    assert point_key(points()[0], SceneFiles()) != point_key(points(plain)[0], SceneFiles())
    assert "missed_hits" not in metrics(plain)


def test_the_reference_has_the_most_exact_shape_of_the_experiment():
    text = GAS.replace("shape: sphere", "mesh: pumpkin-1753.ply") + "sweep: {shape: [sphere, hull, mesh]}\n"
    assert {point.reference.shape for point in points(text)} == {"mesh"}
    assert {point.reference.shape for point in points(text.replace(", mesh]", "]"))} == {"hull"}
    assert {point.reference.shape for point in points()} == {"sphere"}
