"""How far off a motion is, on made-up runs of a body between two walls."""

import numpy as np
import pytest

from harness.motion.hits import Trace
from harness.reference.events import Events
from harness.reference.position_errors import UNIT, ReferenceEvents, in_another_unit, position_errors
from tests.conftest import make_bodies, random_scene

BODIES = make_bodies([[0, 0, 0]], [[1, 0, 0]])


def bounces(*times):
    """The body meets x+, x-, x+, … at these times."""
    walls = np.array([1, 0] * len(times), np.int64)[: len(times)]
    return Events(np.array(times, float), np.array([[0, -1]] * len(times)).reshape(-1, 2), walls)


def errors(run, exact, twin, until=8.0):
    trace = Trace(*run, until, np.zeros((1, 3)), np.zeros((1, 3)), 0.0, {})
    return position_errors(BODIES, trace, ReferenceEvents(exact, twin), 8.0, "reflect", 1.0)


def test_a_late_bounce_is_off_by_twice_the_way_flown_too_far():
    found = errors(bounces(2.25, 6.25), bounces(2, 6), bounces(2, 6))
    assert found["divergence_time"] == found["reference_divergence_time"] == 8.0
    assert found["position_error"] == pytest.approx(0.5)
    assert found["reference_position_error"] == 0.0


def test_after_a_bounce_that_only_one_of_two_runs_has_nothing_is_compared():
    found = errors(bounces(2), bounces(2, 6), bounces(2, 6))
    assert (found["divergence_time"], found["position_error"]) == (6.0, 0.0)
    assert errors(bounces(2, 6), bounces(2, 6), bounces(2))["reference_divergence_time"] == 6.0


def test_motions_that_differ_from_the_start_have_no_position_error():
    assert "position_error" not in errors(bounces(), bounces(0.0), bounces(0.0))


def test_another_unit_scales_every_length_and_no_angle_and_no_time():
    scene = random_scene("hull", 3, 3.0)
    other = in_another_unit(scene)
    for name in ("positions", "velocities", "sizes"):
        assert np.array_equal(getattr(other.bodies, name), getattr(scene.bodies, name) * UNIT)
    assert np.array_equal(other.bodies.spins, scene.bodies.spins)
    assert np.array_equal(other.box.half, scene.box.half * UNIT)
