"""Times of impact: closed forms, spheres in the limit, and sampling."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from harness.narrowphase.advancement import time_of_impact, time_of_wall_impact
from harness.narrowphase.free_flight import Motion
from harness.narrowphase.gjk import COLD_START, MARGIN, hull_distance, relative_pose
from harness.narrowphase.support import support_map
from harness.narrowphase.vectors import rotation
from harness.narrowphase.verdicts import SearchVerdict
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import MESHES, mesh_named, turns

STRAIGHT = (1.0, 0.0, 0.0, 0.0)
WIDTH = 1 / np.sqrt(3)
CUBE = support_map(cube_mesh().hull.vertices)


def body(position=(0, 0, 0), velocity=(0, 0, 0), quaternion=STRAIGHT, spin=(0, 0, 0), size=1.0):
    vectors = [tuple(map(float, v)) for v in (position, velocity, quaternion, spin)]
    return Motion(*vectors, float(size), size / 2)


def impact(a, b, hull=CUBE, begin=0.0, end=np.inf, tolerance=1e-9, start=COLD_START):
    return time_of_impact(hull, hull, a, b, begin, float(end), tolerance, start)


def gap_at(a, b, hull, time):
    """The distance of two hulls at a time, by other means than those of the search."""
    turned = [
        (Rotation.from_rotvec(np.multiply(m.spin, time)) * Rotation.from_quat(np.roll(m.quaternion, -1))).as_quat()
        for m in (a, b)
    ]
    places = [np.array(m.position) + np.multiply(m.velocity, time) for m in (a, b)]
    turn_a, turn_b = (rotation(q[3], q[0], q[1], q[2]) for q in turned)
    pose = relative_pose(turn_a, a.size, turn_b, b.size, tuple(places[1] - places[0]))
    return hull_distance(hull, hull, pose, COLD_START, (1.0, 0.0, 0.0), MARGIN * (a.size + b.size), np.inf, 0.0).lower


def test_cubes_that_meet_face_to_face_do_so_on_time():
    found = impact(body(), body(position=(5, 0.1, 0.2), velocity=(-1.0, 0, 0)))
    assert found.verdict == SearchVerdict.FOUND
    assert found.steps <= 3
    assert found.time == pytest.approx(5 - WIDTH, rel=1e-9)
    assert found.axis == pytest.approx((-1, 0, 0))


def test_an_edge_meets_a_face_after_the_width_of_the_diagonal():
    slanted = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8))
    found = impact(body(), body(position=(3, 0, 0), velocity=(-2.0, 0, 0), quaternion=slanted))
    assert found.time == pytest.approx((3 - WIDTH * (1 + np.sqrt(2)) / 2) / 2, rel=1e-9)


def test_a_spinning_cube_meets_a_face_when_its_edge_has_turned_there():
    rate, speed, start = 2.0, 0.3, 1.5

    def gap(t):
        reach = WIDTH / 2 * (abs(np.cos(rate * t)) + abs(np.sin(rate * t)))
        return start - speed * t - WIDTH / 2 - reach

    times = np.linspace(0, 4, 40_001)
    after = np.argmax(gap(times) <= 0)
    expected = brentq(gap, times[after - 1], times[after], xtol=1e-14)
    found = impact(body(), body(position=(start, 0, 0), velocity=(-speed, 0, 0), spin=(0, 0, rate)), tolerance=1e-11)
    assert found.time == pytest.approx(expected, abs=1e-9)
    assert found.time <= expected + 1e-12
    wall = time_of_wall_impact(
        CUBE, body(velocity=(speed, 0, 0), spin=(0, 0, rate)), 1, start - WIDTH / 2, 0.0, np.inf, 1e-11
    )
    assert wall.time == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("wall", range(6))
def test_a_cube_meets_each_wall_on_time_and_one_behind_it_never(wall):
    towards = np.zeros(3)
    towards[wall // 2] = 2.0 * (wall % 2) - 1.0
    flying = body(position=0.1 * towards, velocity=2.0 * towards)
    found = time_of_wall_impact(CUBE, flying, wall, 4.0, 0.0, np.inf, 1e-12)
    assert found.verdict == SearchVerdict.FOUND
    assert found.time == pytest.approx((3.9 - WIDTH / 2) / 2, rel=1e-11)
    assert time_of_wall_impact(CUBE, flying, wall ^ 1, 4.0, 0.0, np.inf, 1e-12).verdict == SearchVerdict.NEVER


def test_icospheres_converge_to_the_sphere_with_the_square_of_their_edges():
    offset, velocity = np.array([3.0, 0.3, 0.2]), np.array([-1.0, 0.05, 0.0])
    b, c, v2 = offset @ velocity, offset @ offset - 1.0, velocity @ velocity
    exact = c / (-b + np.sqrt(b * b - v2 * c))
    errors, lengths = [], []
    for level in (1, 2, 3, 4):
        sphere = trimesh.creation.icosphere(subdivisions=level, radius=0.5)
        hull, found = support_map(np.array(sphere.vertices)), []
        for q, p in zip(turns(np.random.default_rng(0), 20), turns(np.random.default_rng(1), 20), strict=True):
            a, b_ = body(quaternion=q, spin=(0.5, 1, 2)), body(offset, velocity, quaternion=p, spin=(1, -2, 0))
            found.append(impact(a, b_, hull, tolerance=1e-10).time - exact)
        assert min(found) > -1e-9  # inscribed, so they meet later
        errors.append(np.mean(found))
        lengths.append(sphere.edges_unique_length.mean())
    orders = np.diff(np.log(errors)) / np.diff(np.log(lengths))
    assert (abs(orders - 2) < 0.35).all()


@pytest.mark.slow
@settings(max_examples=60)
@given(st.integers(0, 10**6), st.sampled_from(["cube", *MESHES]), st.sampled_from([0.0, 3.0, 30.0]))
def test_nothing_touches_before_an_impact_and_at_it_the_gap_is_within_tolerance(seed, name, spin):
    rng = np.random.default_rng(seed)
    hull = CUBE if name == "cube" else support_map(mesh_named(name).hull.vertices)
    sizes = rng.uniform(0.5, 2, 2)
    offset = rng.normal(size=3)
    offset *= sizes.sum() / 2 * rng.uniform(1, 2) / np.linalg.norm(offset)
    a = body(quaternion=turns(rng, 1)[0], spin=rng.normal(size=3) * spin, size=sizes[0])
    aim = -offset + rng.normal(size=3) * 0.5
    b = body(offset, aim, quaternion=turns(rng, 1)[0], spin=rng.normal(size=3) * spin, size=sizes[1])
    found = impact(a, b, hull, end=3.0, tolerance=1e-7)
    assert found.verdict in (SearchVerdict.FOUND, SearchVerdict.NEVER)
    until = min(found.time, 3.0)
    gaps = [gap_at(a, b, hull, t) for t in np.linspace(0, until, 100)[:-1]]
    assert min(gaps) > 0
    if found.verdict == SearchVerdict.FOUND:
        assert 0 <= gap_at(a, b, hull, found.time) <= 1.01e-7
        again = impact(a, b, hull, end=3.0, tolerance=1e-7, start=found.warm_start)
        assert again.time == pytest.approx(found.time, abs=1e-6)


def test_a_smaller_tolerance_is_later_and_nearer():
    a, b = body(), body(position=(3, 0.2, 0.1), velocity=(-1.0, 0, 0), spin=(0.3, 1, 2))
    times = [impact(a, b, tolerance=t).time for t in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)]
    assert times == sorted(times)
    assert abs(times[-1] - times[-2]) < 1e-7


def test_overlapping_hulls_touch_at_the_beginning_and_a_window_ends_the_search():
    assert impact(body(), body(position=(0.3, 0, 0)), begin=2.0)[:2] == (SearchVerdict.FOUND, 2.0)
    flying = body(position=(5, 0, 0), velocity=(-1.0, 0, 0))
    assert impact(body(), flying, end=2.0)[:2] == (SearchVerdict.NEVER, 2.0)
    assert impact(body(), body(position=(5, 0, 0), velocity=(1.0, 0, 0)))[:2] == (SearchVerdict.NEVER, np.inf)


def test_spin_about_the_line_of_approach_costs_no_steps():
    found = impact(body(), body(position=(3, 0, 0), velocity=(-1.0, 0, 0), spin=(50.0, 0, 0)))
    assert found.steps <= 4
