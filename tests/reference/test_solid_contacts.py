"""Contacts of hulls and surfaces on folded paths, against closed forms and against FCL, moment by moment."""

import numpy as np
import pytest

from harness.motion.kinematics import Trajectory
from harness.reference.solid_contacts import solid_contacts
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene
from tests.methods.flights import detector

SIDE = 1 / np.sqrt(3)
TOLERANCE = 1e-10


def contacts(shape, positions, velocities, duration, half=50.0):
    bodies = make_bodies(positions, velocities)
    found = solid_contacts(Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, half))), duration, TOLERANCE)
    return list(zip(found.onset.tolist(), found.release.tolist(), strict=True))


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_cubes_that_pass_through_each_other_touch_from_face_to_face(shape):
    """They do not stand exactly behind each other, so that their surfaces cross all the while."""
    ((onset, release),) = contacts(shape, [[-2, 0, 0], [0, 0.1, 0.2]], [[1, 0, 0], [0, 0, 0]], 4.0)
    assert onset == pytest.approx(2 - SIDE, abs=2 * TOLERANCE)
    assert release == pytest.approx(2 + SIDE, abs=2 * TOLERANCE)


def test_cubes_that_pass_beside_each_other_do_not_touch_although_their_spheres_do():
    assert contacts("mesh", [[-2, 0, 0], [0, 0.9, 0]], [[1, 0, 0], [0, 0, 0]], 4.0) == []


def test_a_wall_turns_a_cube_round_in_the_middle_of_a_contact():
    """The sphere of the second cube meets the wall at t = 0.5; it flies on through the first, which rests."""
    ((onset, release),) = contacts("hull", [[1.3, 0, 0], [1.0, 0.1, 0.2]], [[0, 0, 0], [1, 0, 0]], 3.0, half=2.0)
    assert onset == 0.0
    assert release == pytest.approx(0.5 + 0.2 + SIDE, abs=2 * TOLERANCE)


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_spinning_cubes_touch_at_a_moment_where_fcl_says_so(shape):
    scene = random_scene(shape, 8, 3.0, seed=4)
    found = solid_contacts(scene, 2.0, TOLERANCE)
    assert len(found) > 10
    asked, trajectory = detector(scene), Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    for time in np.random.default_rng(0).uniform(0, 2.0, 100):
        trajectory.move_to(time)
        open_now = (found.onset <= time) & (time <= found.release)
        expected = set(map(tuple, asked.pairs(trajectory.positions, trajectory.quaternions).tolist()))
        assert set(map(tuple, found.pairs[found.encounter[open_now]].tolist())) == expected
