"""The two kinds of motion tell the same story as the frames get shorter, until chaos parts them."""

import numpy as np
import pytest

from harness.motion.law import MotionLaw
from harness.scene.box import Box
from harness.scene.launch import directions, place
from harness.scene.scene import Scene
from tests.conftest import make_bodies
from tests.methods.flights import fly, frames_of

DURATION = 1.5


@pytest.fixture(scope="module")
def gas():
    rng = np.random.default_rng(259)
    box = Box(np.full(3, 2.5))
    positions = place(np.full(30, 0.5), box, rng, overlap=False)
    return Scene("sphere", (), make_bodies(positions, directions(rng, 30)), box)


def predicted(scene, response):
    return fly(scene, "predictive", MotionLaw(DURATION, DURATION, response))


def stepped(scene, response, dt):
    return fly(scene, "grid", frames_of(round(DURATION / dt), dt, response))


def sequence(trace):
    return [(*bodies, wall) for bodies, wall in zip(trace.bodies.tolist(), trace.walls.tolist(), strict=True)]


@pytest.mark.slow
@pytest.mark.parametrize("response", ["reflect", "elastic"])
def test_short_frames_see_the_events_in_the_order_of_the_schedule(gas, response):
    exact, frames = predicted(gas, response).trace, stepped(gas, response, 1e-4).trace
    first = 30
    assert sequence(exact)[:first] == sequence(frames)[:first]
    # the first is seen within a frame; later ones inherit what earlier answers were late by, magnified by each hit
    lateness = frames.times[:first] - exact.times[:first]
    assert 0 <= lateness[0] <= 1e-4
    assert np.abs(lateness).max() < 2e-3


@pytest.mark.slow
def test_the_lateness_of_frames_is_of_first_order_in_their_length(gas):
    exact = predicted(gas, "elastic").trace.times[:8]
    lateness = [np.mean(np.abs(stepped(gas, "elastic", dt).trace.times[:8] - exact)) for dt in (4e-3, 1e-3, 2.5e-4)]
    orders = np.log(np.divide(lateness[:-1], lateness[1:])) / np.log(4)
    assert np.all((orders > 0.6) & (orders < 1.4))


def test_without_a_response_both_see_the_same_onsets(gas):
    exact, frames = predicted(gas, "none"), stepped(gas, "none", 1e-3)
    onsets = {
        tuple(bodies) for bodies, wall in zip(exact.trace.bodies.tolist(), exact.trace.walls, strict=True) if wall < 0
    }
    seen = {
        tuple(bodies) for bodies, wall in zip(frames.trace.bodies.tolist(), frames.trace.walls, strict=True) if wall < 0
    }
    assert seen <= onsets
    assert len(seen) >= 0.9 * len(onsets) > 20
    assert exact.metrics["box_hits"] == frames.metrics["box_hits"]
    assert np.allclose(exact.trace.positions, frames.trace.positions, atol=1e-12)
    assert np.allclose(exact.trace.velocities, frames.trace.velocities, atol=1e-12)
