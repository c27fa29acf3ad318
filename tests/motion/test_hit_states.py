"""What is kept of every hit, held against the laws of the hit and of the flight between hits."""

import csv
import io
from itertools import pairwise

import numpy as np
import pytest

from tests.conftest import random_scene
from tests.methods import flights
from tests.methods.flights import frames_of

FRAMES, DT = 60, 1 / 30
METHODS = [("grid", "sphere"), ("predictive", "sphere"), ("predictive", "hull")]


def fly(algorithm, shape, response, restitution=1.0):
    scene = random_scene(shape, 10, 4.0, seed=5)
    return scene, flights.fly(scene, algorithm, frames_of(FRAMES, DT, response, restitution), recorded=True).trace


def hits_of(trace, body):
    """(hit, place of the body in it) of every hit of a body, in order."""
    return [(k, int(bodies[1] == body)) for k, bodies in enumerate(trace.bodies.tolist()) if body in bodies]


@pytest.mark.parametrize("response", ["reflect", "elastic"])
@pytest.mark.parametrize(("algorithm", "shape"), METHODS)
def test_a_body_keeps_its_velocity_from_one_hit_to_the_next_and_flies_straight(algorithm, shape, response):
    scene, trace = fly(algorithm, shape, response)
    states = trace.states
    assert len(trace.times) > 20
    for body in range(len(scene.bodies)):
        position, velocity, time = scene.bodies.positions[body], scene.bodies.velocities[body], 0.0
        for hit in hits_of(trace, body):
            assert (states.velocities_before[hit] == velocity).all()
            assert np.abs(states.positions[hit] - position - velocity * (trace.times[hit[0]] - time)).max() < 1e-13
            position, velocity, time = states.positions[hit], states.velocities_after[hit], trace.times[hit[0]]
        assert (trace.velocities[body] == velocity).all()


@pytest.mark.parametrize("restitution", [1.0, 0.5])
@pytest.mark.parametrize(("algorithm", "shape"), METHODS)
def test_impulses_of_a_pair_are_opposite_along_the_line_of_centres_and_restore_the_approach(
    algorithm, shape, restitution
):
    _, trace = fly(algorithm, shape, "elastic", restitution)
    pairs = trace.walls < 0
    states = trace.states
    impulses, centres = states.impulses[pairs], states.positions[pairs]
    assert np.abs(impulses.sum(axis=1)).max() < 1e-14
    normals = centres[:, 1] - centres[:, 0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert np.abs(np.cross(impulses[:, 0], normals)).max() < 1e-14
    before, after = (
        ((velocities[pairs][:, 1] - velocities[pairs][:, 0]) * normals).sum(axis=1)
        for velocities in (states.velocities_before, states.velocities_after)
    )
    assert (before < 0.0).all()
    assert np.allclose(after, -restitution * before, rtol=1e-12)


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize(("algorithm", "shape"), METHODS)
def test_a_wall_turns_the_component_along_its_normal_inward(algorithm, shape, response):
    scene, trace = fly(algorithm, shape, response)
    walls = np.flatnonzero(trace.walls >= 0)
    assert len(walls) > 5
    for k in walls:
        axis, outward = trace.walls[k] // 2, 1.0 if trace.walls[k] % 2 else -1.0
        before, after = trace.states.velocities_before[k, 0], trace.states.velocities_after[k, 0]
        assert before[axis] * outward > 0.0
        turned = before.copy()
        turned[axis] *= -1.0
        assert (after == turned).all()
        assert np.isnan(trace.states.positions[k, 1]).all()
        assert (trace.states.impulses[k, 0] == scene.bodies.masses[trace.bodies[k, 0]] * (after - before)).all()


def test_nothing_changes_where_bodies_pass_through_each_other():
    _, trace = fly("predictive", "sphere", "none")
    pairs = trace.walls < 0
    assert pairs.sum() > 5
    assert not trace.states.impulses[pairs].any()


@pytest.mark.parametrize(("algorithm", "shape"), METHODS)
def test_what_is_kept_changes_no_hit(algorithm, shape):
    scene, kept = fly(algorithm, shape, "elastic")
    plain = flights.fly(scene, algorithm, frames_of(FRAMES, DT, "elastic")).trace
    assert plain.states is None
    for name in ("times", "bodies", "walls", "positions", "velocities"):
        assert (getattr(kept, name) == getattr(plain, name)).all()
    assert kept.counters == plain.counters


def test_json_and_csv_say_the_same():
    _, trace = fly("predictive", "sphere", "elastic")
    events = trace.to_json()["events"]
    rows = list(csv.DictReader(io.StringIO(trace.to_csv())))
    assert len(events) == len(rows) == len(trace.times)
    assert all(first["time"] <= second["time"] for first, second in pairwise(events))
    columns = {
        "position": "positions",
        "velocity_before": "velocities_before",
        "velocity_after": "velocities_after",
        "impulse": "impulses",
    }
    for event, row in zip(events, rows, strict=True):
        assert (row["kind"], int(row["body"]), row["wall"]) == (
            event["kind"],
            event["bodies"][0],
            event.get("wall", ""),
        )
        for column, name in columns.items():
            assert len(event[name]) == len(event["bodies"])
            assert [float(row[f"{column}_{axis}"]) for axis in "xyz"] == event[name][0]
            other = [row[f"other_{column}_{axis}"] for axis in "xyz"]
            assert other == ["", "", ""] if event["kind"] == "wall" else list(map(float, other)) == event[name][1]
