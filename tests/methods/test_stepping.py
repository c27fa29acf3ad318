"""Stepped motion: counts, order, conservation, and what its frames must see."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.methods.penetration import Penetration, _HullDepth
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies, random_scene, slow_beyond
from tests.methods import flights
from tests.methods.flights import frames_of


def fly(scene, *, frames=100, dt=1 / 60, response="reflect", backend="fcl", restitution=1.0, forced=None):
    law = frames_of(frames, dt, response, restitution)
    return flights.fly(scene, flights.default_algorithm(backend), law, backend=backend, forced=forced)


def spheres(positions, velocities, side=10.0, **more):
    return Scene("sphere", (), make_bodies(positions, velocities, **more), Box(np.full(3, side / 2)))


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_brute_force_counts_every_pair_and_every_wall_of_every_frame(shape):
    metrics = fly(random_scene(shape, 12, 5.0), frames=50).metrics
    assert metrics["frames"] == 50
    assert metrics["pair_tests"] == metrics["narrow_tests"] == 50 * 66
    assert metrics["box_tests"] == 50 * 6 * 12
    assert metrics["events"] == metrics["pair_hits"] + metrics["box_hits"]


def test_a_head_on_pair_is_answered_in_the_first_frame_that_sees_it():
    outcome = fly(spheres([[-2, 0, 0], [2, 0, 0]], [[1, 0, 0], [-1, 0, 0]]), frames=120, dt=1 / 60)
    trace = outcome.trace
    assert trace.times.tolist() == [90 / 60]  # touching is a hit: the gap closes at exactly t = 1.5
    assert trace.bodies.tolist() == [[0, 1]]
    assert trace.velocities.tolist() == [[-1, 0, 0], [1, 0, 0]]
    assert trace.positions[:, 0] == pytest.approx([-1.0, 1.0])


def test_walls_are_answered_after_pairs_with_what_these_left():
    # the pair sends body 1 toward the wall that it touches already, and the wall sends it back in the same frame
    scene = spheres([[3.5, 0, 0], [4.6, 0, 0]], [[2, 0, 0], [-1, 0, 0]])
    trace = fly(scene, frames=1, dt=0.06, response="elastic").trace
    assert trace.bodies.tolist() == [[0, 1], [1, -1]]
    assert trace.walls.tolist() == [-1, 1]
    assert trace.velocities[:, 0].tolist() == [-1, -2]


@pytest.mark.parametrize("response", slow_beyond(["reflect", "elastic"]))
@pytest.mark.parametrize("shape", slow_beyond(["sphere", "hull"]))
def test_energy_is_kept_and_no_centre_leaves_a_crowded_box(shape, response):
    metrics = fly(random_scene(shape, 30, 3.0), frames=300, response=response).metrics
    assert metrics["pair_hits"] > 100
    assert metrics["energy_drift"] < 1e-13
    assert metrics["escaped"] == 0
    assert 0 < metrics["max_penetration"] < 1
    assert metrics.get("momentum_drift", 0.0) < 1e-13


def test_restitution_takes_energy():
    trace = fly(
        spheres([[-2, 0, 0], [2, 0, 0]], [[1, 0, 0], [-1, 0, 0]]), frames=120, response="elastic", restitution=0.5
    ).trace
    assert trace.velocities.tolist() == [[-0.5, 0, 0], [0.5, 0, 0]]


def test_with_no_response_a_hit_is_the_first_frame_that_sees_a_contact():
    outcome = fly(spheres([[-2, 0, 0], [2, 0, 0]], [[1, 0, 0], [-1, 0, 0]]), frames=300, dt=1 / 60, response="none")
    pair_hits = outcome.trace.walls == -1
    assert outcome.metrics["pair_hits"] == pair_hits.sum() == 1
    assert outcome.trace.times[pair_hits].tolist() == [1.5]
    # they overlap from t = 1.5 to 2.5, both ends included, and one of these frames is the hit
    assert outcome.metrics["pair_contacts"] == 60
    assert outcome.metrics["box_hits"] == 0


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000))
def test_both_backends_fly_the_same_spheres_alike(seed):
    scene = random_scene("sphere", 15, 4.0, seed)
    ours, theirs = (fly(scene, frames=60, backend=backend).trace for backend in ("fcl", "pybullet"))
    assert ours.times.tolist() == theirs.times.tolist()
    assert ours.bodies.tolist() == theirs.bodies.tolist()
    assert ours.positions.tolist() == theirs.positions.tolist()


def test_one_body_needs_no_pairs_and_none_at_all_is_a_run_too():
    for count in (0, 1):
        positions = np.zeros((count, 3))
        metrics = fly(spheres(positions, positions), frames=5).metrics
        assert metrics["pair_tests"] == 0
        assert metrics["box_tests"] == 30 * count
        assert metrics["energy_drift"] == 0.0


def test_no_frames_is_a_run_that_ends_where_it_starts():
    scene = random_scene("sphere", 3, 5.0)
    outcome = fly(scene, frames=0)
    assert outcome.trace.time == 0.0
    assert outcome.trace.positions.tolist() == scene.bodies.positions.tolist()
    assert "pair_seconds_per_frame" not in outcome.metrics


def test_forcing_the_wall_cull_off_changes_no_event():
    scene = random_scene("hull", 20, 4.0)
    kept, forced = fly(scene, backend="pybullet"), fly(scene, backend="pybullet", forced={"wall_cull": False})
    assert kept.trace.times.tolist() == forced.trace.times.tolist()
    assert kept.trace.bodies.tolist() == forced.trace.bodies.tolist()


def test_hulls_are_asked_how_deep_they_are_only_where_they_may_be_deepest(monkeypatch):
    scene = random_scene("hull", 40, 4.0)
    touching = np.array([[i, j] for i in range(40) for j in range(i + 1, 40)])
    apart = np.linalg.norm(scene.bodies.positions[touching[:, 0]] - scene.bodies.positions[touching[:, 1]], axis=1)
    touching = touching[apart < 0.6]
    poses, measure = (scene.bodies.positions, scene.bodies.quaternions), Penetration(scene)
    each = [measure.deepest(pair[None], *poses) for pair in touching]
    asked = []
    depth = _HullDepth.depth
    monkeypatch.setattr(_HullDepth, "depth", lambda self, *told: asked.append(told[:2]) or depth(self, *told))
    assert measure.deepest(touching, *poses) == max(each) > 0.0
    assert 0 < len(asked) < len(touching) / 2
    asked.clear()
    assert measure.deepest(touching, *poses, known=1.0) == 1.0
    assert not asked
