"""Free flight against closed forms and independent rotations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from harness.motion.kinematics import Trajectory
from harness.scene.box import Box
from tests.conftest import make_bodies

SIDE = 10.0
BOX = Box(np.full(3, SIDE / 2))
ROOM = SIDE / 2 - 0.5


def folded_along_x(x, v, time):
    trajectory = Trajectory(make_bodies([[x, 0, 0]], [[v, 0, 0]]), BOX, folded=True, turning=False)
    trajectory.move_to(time)
    return trajectory


def test_a_body_flies_straight_from_where_it_was_last_redirected():
    trajectory = Trajectory(make_bodies([[1, 2, 3]], [[1, 0, -1]]), BOX, folded=False, turning=False)
    trajectory.move_to(2.0)
    assert trajectory.positions.tolist() == [[3, 2, 1]]
    trajectory.velocities[0] = [0, 1, 0]
    trajectory.redirect(np.array([True]), 2.0)
    trajectory.move_to(5.0)
    assert trajectory.positions.tolist() == [[3, 5, 1]]


def test_going_back_in_time_undoes_every_rounding():
    trajectory = Trajectory(make_bodies([[0.1, 0.2, 0.3]], [[0.7, 1.1, -0.3]]), BOX, folded=False, turning=False)
    for time in np.linspace(0, 1e6, 1001):
        trajectory.move_to(time)
    trajectory.move_to(0.0)
    assert trajectory.positions.tolist() == [[0.1, 0.2, 0.3]]


@given(st.tuples(*[st.floats(-10, 10)] * 3), st.floats(0, 100))
def test_spin_turns_about_a_world_axis_by_rate_times_time(spin, time):
    start = Rotation.from_euler("xyz", [0.3, -1.0, 2.0])
    x, y, z, w = start.as_quat()
    bodies = make_bodies([[0, 0, 0]], spins=[spin], quaternions=[[w, x, y, z]])
    trajectory = Trajectory(bodies, BOX, folded=False, turning=True)
    trajectory.move_to(time)
    turned = Rotation.from_rotvec(np.array(spin) * time) * start
    matrix = Rotation.from_quat(trajectory.quaternions[0, [1, 2, 3, 0]]).as_matrix()
    assert np.allclose(matrix, turned.as_matrix(), atol=1e-11)


def test_a_quaternion_stays_a_unit_after_a_million_turns():
    bodies = make_bodies([[0, 0, 0]], spins=[[3.0, 4.0, 12.0]])
    trajectory = Trajectory(bodies, BOX, folded=False, turning=True)
    trajectory.move_to(1e6)
    assert np.linalg.norm(trajectory.quaternions[0]) == pytest.approx(1.0, abs=1e-15)


@given(st.floats(-ROOM, ROOM), st.floats(-50, 50), st.floats(0, 100))
def test_a_folded_path_is_where_reflecting_step_by_step_puts_it(x, v, time):
    trajectory = folded_along_x(x, v, time)
    position, velocity, left, hits = x, v, time, 0
    if (position == ROOM and v > 0) or (position == -ROOM and v < 0):
        velocity, hits = -v, 1
    while velocity != 0:
        wall = ROOM if velocity > 0 else -ROOM
        to_wall = (wall - position) / velocity
        if to_wall > left:
            break
        position, velocity, left, hits = wall, -velocity, left - to_wall, hits + 1
    expected = position + velocity * left
    assert trajectory.positions[0, 0] == pytest.approx(expected, abs=1e-9 * (1 + abs(v) * time))
    near_a_wall = abs(abs(expected) - ROOM) < 1e-6 * (1 + abs(v))
    if not near_a_wall:
        assert int(trajectory.folds(time).sum()) == hits
        assert trajectory.velocities_at(time)[0, 0] == velocity


def test_a_fold_after_18_000_seconds_is_exact_to_1e_10():
    trajectory = folded_along_x(0.0, 1.0, 18_000.0)
    phase = (18_000.0 + ROOM) % (4 * ROOM)
    expected = phase - ROOM if phase <= 2 * ROOM else 3 * ROOM - phase
    assert trajectory.positions[0, 0] == pytest.approx(expected, abs=1e-10)


def test_walls_take_turns_on_a_folded_path():
    trajectory = folded_along_x(0.0, 1.0, 0.0)
    assert trajectory.folds(ROOM + 0.1)[0].tolist() == [0, 1, 0, 0, 0, 0]
    assert trajectory.folds(3 * ROOM + 0.1)[0].tolist() == [1, 1, 0, 0, 0, 0]


def test_a_body_beyond_a_wall_flies_in_before_it_is_folded():
    trajectory = folded_along_x(ROOM + 0.3, -1.0, 0.1)
    assert trajectory.positions[0, 0] == pytest.approx(ROOM + 0.2)
    outward = folded_along_x(ROOM + 0.3, 1.0, 0.1)
    assert outward.positions[0, 0] == pytest.approx(ROOM + 0.2)
    assert outward.folds(0.1)[0].tolist() == [0, 1, 0, 0, 0, 0]


def test_a_box_as_large_as_the_body_holds_it_still():
    trajectory = Trajectory(
        make_bodies([[0, 0, 0]], [[3, 0, 0]]), Box(np.array([0.5, 5, 5])), folded=True, turning=False
    )
    trajectory.move_to(1.0)
    assert trajectory.positions.tolist() == [[0, 0, 0]]
