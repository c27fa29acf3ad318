"""Spinning hulls and meshes from event to event, against closed forms, a plain loop, spheres and frames."""

import numpy as np
import pytest
from scipy.optimize import brentq

from harness.motion.predictive.solid_simulation import SolidSimulation
from harness.motion.predictive.solids import Form
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies
from tests.motion.solid_reference import SolidReference
from tests.narrowphase.meshes import mesh_named, turns

WIDTH = 1 / np.sqrt(3)
PUMPKIN = "pumpkin-1753.ply"


def fly(scene, until, response="elastic", restitution=1.0, tolerance=1e-9, max_events=None):
    simulation = SolidSimulation(
        scene.bodies, scene.box, Form(scene), response, restitution, record=True, tolerance=tolerance
    )
    simulation.advance(until, max_events)
    return simulation


def cubes(positions, velocities, half=50.0, **options):
    return Scene("hull", cube_mesh(), make_bodies(positions, velocities, **options), Box(np.full(3, float(half))))


def crowd(mesh, count, half, seed, shape="hull", spin=2.0, ratio=1.0):
    """Bodies on a jittered lattice, so that their spheres hardly overlap at the start."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(count ** (1 / 3)))
    steps = (np.arange(side) + 0.5) / side * 2 - 1
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3) * (half - 0.1)
    positions = places[rng.permutation(len(places))[:count]] + rng.uniform(-0.05, 0.05, (count, 3))
    bodies = make_bodies(
        positions,
        rng.normal(size=(count, 3)),
        quaternions=turns(rng, count),
        spins=rng.normal(size=(count, 3)) * spin,
        sizes=ratio ** rng.uniform(-1, 0, count),
    )
    return Scene(shape, mesh, bodies, Box(np.full(3, float(half))))


def sequence(events):
    return [(int(e["kind"]), int(e["i"]), int(e["wall"] if e["kind"] else e["j"])) for e in events]


def until_too_close_to_call(events, tolerance=1e-6):
    """The events up to the first two of which rounding decides which is first."""
    close = np.flatnonzero(np.diff([event[0] for event in events]) <= tolerance)
    return events[: close[0]] if len(close) else events


def test_cubes_meet_face_to_face_and_edge_to_face_on_time():
    slanted = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8))
    for turn, reach in (((1, 0, 0, 0), WIDTH), (slanted, WIDTH * (1 + np.sqrt(2)) / 2)):
        scene = cubes([(0, 0, 0), (5, 0, 0)], [(0.5, 0, 0), (-1, 0, 0)], quaternions=[(1, 0, 0, 0), turn])
        events = fly(scene, 10.0, tolerance=1e-12).events
        assert sequence(events) == [(0, 0, 1)]
        assert events["time"][0] == pytest.approx((5 - reach) / 1.5, rel=1e-11)


def test_a_spinning_cube_meets_a_cube_and_a_wall_when_its_edge_has_turned_there():
    rate, speed = 2.0, 0.3

    def gap(t, distance):
        return distance - speed * t - WIDTH / 2 * (abs(np.cos(rate * t)) + abs(np.sin(rate * t)))

    def first(distance):
        times = np.linspace(0, 8, 80_001)
        after = np.argmax(gap(times, distance) <= 0)
        return brentq(gap, times[after - 1], times[after], args=(distance,), xtol=1e-14)

    scene = cubes([(0, 0, 0), (1.5, 0, 0)], [(0, 0, 0), (-speed, 0, 0)], spins=[(0, 0, 0), (0, 0, rate)])
    assert fly(scene, 5.0, tolerance=1e-11).events["time"][0] == pytest.approx(first(1.5 - WIDTH / 2), abs=1e-9)
    alone = cubes([(0, 0, 0)], [(speed, 0, 0)], half=1.9, spins=[(0, 0, rate)])
    assert fly(alone, 7.0, tolerance=1e-11).events["time"][0] == pytest.approx(first(1.9), abs=1e-9)


@pytest.mark.parametrize(
    ("name", "response", "restitution", "ratio"),
    [("cube", "reflect", 1.0, 1.0), ("cube", "elastic", 0.8, 3.0), (PUMPKIN, "elastic", 1.0, 1.5)],
)
def test_the_scheduler_meets_the_events_of_the_plain_loop(name, response, restitution, ratio):
    mesh = cube_mesh() if name == "cube" else mesh_named(name)
    compared = 0
    for seed in range(4):
        scene = crowd(mesh, 5, 1.1, seed, ratio=ratio)
        reference = SolidReference(scene, response, restitution)
        while len(reference.events) < 12 and reference.happen():
            pass
        expected = until_too_close_to_call(reference.events)
        found = fly(scene, np.inf, response, restitution, 1e-12, max_events=12).events[: len(expected)]
        assert sequence(found) == [event[1:] for event in expected]
        # chaos multiplies rounding by some ten a hit
        errors = np.abs(found["time"] - [event[0] for event in expected])
        assert errors[0] < 1e-9
        assert errors.max() < 1e-5
        compared += len(expected)
    assert compared >= 40
