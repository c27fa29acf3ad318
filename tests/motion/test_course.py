"""The course of a recorded run: the legs say where every body is, and recording changes nothing."""

import numpy as np
import pytest

from harness.motion.course import folded_course
from harness.motion.kinematics import Trajectory
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies, random_scene
from tests.methods import flights
from tests.methods.flights import frames_of

DURATION, FRAMES = 3.0, 90


def fly(scene, algorithm, response, recorded=True):
    return flights.fly(scene, algorithm, frames_of(FRAMES, DURATION / FRAMES, response), recorded=recorded)


def positions_at(course, time, count):
    """(n, 3) by the last leg that has begun, of each body."""
    found = np.empty((count, 3))
    for body in range(count):
        leg = np.flatnonzero((course.bodies == body) & (course.times <= time))[-1]
        found[body] = course.positions[leg] + course.velocities[leg] * (time - course.times[leg])
    return found


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize(
    ("algorithm", "shape"), [("brute-force", "sphere"), ("predictive", "sphere"), ("predictive", "hull")]
)
def test_legs_join_and_end_where_the_run_ends(algorithm, shape, response):
    scene = random_scene(shape, 12, 5.0, seed=3)
    outcome = fly(scene, algorithm, response)
    course = outcome.course
    assert len(course.times) > 2 * len(scene.bodies)
    for body in range(len(scene.bodies)):
        legs = np.flatnonzero(course.bodies == body)
        flown = course.positions[legs[:-1]] + course.velocities[legs[:-1]] * np.diff(course.times[legs])[:, None]
        assert np.abs(flown - course.positions[legs[1:]]).max(initial=0.0) < 1e-13
    ended = positions_at(course, outcome.trace.time, len(scene.bodies))
    assert np.abs(ended - outcome.trace.positions).max() < 1e-13
    assert (course.times[: len(scene.bodies)] == 0.0).all()
    assert (course.bodies[: len(scene.bodies)] == np.arange(len(scene.bodies))).all()


@pytest.mark.parametrize("algorithm", ["brute-force", "predictive"])
def test_recording_changes_no_hit(algorithm):
    scene = random_scene("sphere", 12, 4.0, seed=5)
    recorded, plain = (fly(scene, algorithm, "elastic", recorded=kept) for kept in (True, False))
    assert plain.course is None
    assert len(plain.trace.times) > 20
    for name in ("times", "bodies", "walls", "positions", "velocities"):
        assert (getattr(recorded.trace, name) == getattr(plain.trace, name)).all()


def test_an_answered_hit_begins_a_leg_of_each_body_that_it_turned():
    outcome = fly(random_scene("sphere", 12, 4.0, seed=5), "predictive", "elastic")
    begun = set(zip(outcome.course.times.tolist(), outcome.course.bodies.tolist(), strict=True))
    for time, bodies in zip(outcome.trace.times.tolist(), outcome.trace.bodies.tolist(), strict=True):
        assert all((time, body) in begun for body in bodies if body >= 0)


def test_folded_legs_agree_with_the_closed_form_also_from_beyond_a_wall():
    bodies = make_bodies(
        [[0.3, 0, 0], [2.5, 0, 0], [2.5, 0, 0]],
        [[1.7, -0.4, 0], [0.8, 0, 0], [-0.8, 0, 1]],
    )
    box = Box(np.array([2.0, 1.5, 3.0]))
    course = folded_course(bodies, box, 20.0)
    trajectory = Trajectory(bodies, box, folded=True, turning=False)
    for time in np.linspace(0.01, 20, 57):
        trajectory.move_to(time)
        assert np.abs(positions_at(course, time, 3) - trajectory.positions).max() < 1e-12


def test_a_scene_without_bodies_has_a_course_without_legs():
    scene = Scene("sphere", (), make_bodies([]), Box(np.ones(3)))
    assert len(fly(scene, "predictive", "reflect").course.times) == 0
