"""Times of impact of surfaces: closed forms, spheres in the limit, hulls, and FCL at tiny steps."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from harness.narrowphase.advancement import time_of_impact
from harness.narrowphase.clearance_field import no_field
from harness.narrowphase.free_flight import attitude, place, seen_at
from harness.narrowphase.gjk import COLD_START
from harness.narrowphase.mesh_advancement import MESH_COLD_START, MeshShape, first_touch, time_of_mesh_impact
from harness.narrowphase.support import support_map
from harness.narrowphase.tree_pairs import NO_NODES, Trees
from harness.narrowphase.triangle_tree import triangle_tree
from harness.narrowphase.verdicts import SearchVerdict
from tests.conftest import examples
from tests.narrowphase.flights import STRAIGHT, Truth, body, encounter, shape_named
from tests.narrowphase.meshes import MESHES, mesh_named, turns

WIDTH = 1 / np.sqrt(3)


def impact(a, b, name="cube", begin=0.0, end=np.inf, tolerance=1e-9, start=MESH_COLD_START):
    shape = shape_named(name) if isinstance(name, str) else name
    return time_of_mesh_impact(shape, shape, a, b, begin, float(end), tolerance, start)


def test_cubes_that_meet_face_to_face_edge_to_face_and_corner_to_face_do_so_on_time():
    slanted = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8))
    tilt = np.arccos(1 / np.sqrt(3)) / 2  # a space diagonal turned on to the x axis
    on_corner = (np.cos(tilt), 0, np.sin(tilt) / np.sqrt(2), -np.sin(tilt) / np.sqrt(2))
    for quaternion, reach in ((STRAIGHT, WIDTH / 2), (slanted, WIDTH / np.sqrt(2)), (on_corner, 0.5)):
        found = impact(body(), body((5, 0.1, 0.07), (-2.0, 0, 0), quaternion))
        assert found.verdict == SearchVerdict.FOUND
        assert found.time == pytest.approx((5 - WIDTH / 2 - reach) / 2, rel=1e-9)
        assert found.axis == pytest.approx((-1, 0, 0), abs=1e-6)


def test_crossed_edges_meet_on_time():
    about_z, about_y = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)), (np.cos(np.pi / 8), 0, np.sin(np.pi / 8), 0)
    found = impact(body(quaternion=about_z), body((4, 0.1, 0.05), (-1.0, 0, 0), about_y))
    assert found.time == pytest.approx(4 - np.sqrt(2) * WIDTH, rel=1e-9)


@pytest.mark.parametrize("rate", [2.0, 40.0])
def test_a_spinning_cube_meets_a_face_when_its_edge_has_turned_there(rate):
    speed, start = 0.3, 1.5

    def gap(t):
        reach = WIDTH / 2 * (abs(np.cos(rate * t)) + abs(np.sin(rate * t)))
        return start - speed * t - WIDTH / 2 - reach

    times = np.linspace(0, 4, 400_001)
    after = np.argmax(gap(times) <= 0)
    expected = brentq(gap, times[after - 1], times[after], xtol=1e-14)
    found = impact(body(), body((start, 0.01, 0.02), (-speed, 0, 0), spin=(0, 0, rate)), tolerance=1e-11)
    assert found.time == pytest.approx(expected, abs=1e-9)
    assert found.time <= expected + 1e-12


def test_icospheres_converge_to_the_sphere_with_the_square_of_their_edges():
    offset, velocity = np.array([3.0, 0.3, 0.2]), np.array([-1.0, 0.05, 0.0])
    b, c, v2 = offset @ velocity, offset @ offset - 1.0, velocity @ velocity
    exact = c / (-b + np.sqrt(b * b - v2 * c))
    errors, lengths = [], []
    for level in (1, 2, 3, 4):
        sphere = trimesh.creation.icosphere(subdivisions=level, radius=0.5)
        vertices = np.array(sphere.vertices)
        shape = MeshShape(
            support_map(vertices), triangle_tree(vertices, np.array(sphere.faces, np.int32)), 0.5, no_field()
        )
        found = []
        for q, p in zip(turns(np.random.default_rng(0), 20), turns(np.random.default_rng(1), 20), strict=True):
            a, b_ = body(quaternion=q, spin=(0.5, 1, 2)), body(offset, velocity, quaternion=p, spin=(1, -2, 0))
            found.append(impact(a, b_, shape, tolerance=1e-10).time - exact)
            hulls = time_of_impact(shape.hull, shape.hull, a, b_, 0.0, np.inf, 1e-10, COLD_START)
            assert found[-1] == pytest.approx(hulls.time - exact, abs=1e-8)  # a convex surface is its hull
        assert min(found) > -1e-9  # inscribed, so they meet later
        errors.append(np.mean(found))
        lengths.append(sphere.edges_unique_length.mean())
    orders = np.diff(np.log(errors)) / np.diff(np.log(lengths))
    assert (abs(orders - 2) < 0.35).all()


@pytest.mark.slow
@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(MESHES), st.sampled_from([0.0, 3.0, 15.0]))
def test_nothing_touches_before_an_impact_and_at_it_the_gap_is_within_tolerance(seed, name, spin):
    a, b = encounter(seed, spin)
    found = impact(a, b, name, end=1.0, tolerance=1e-7)
    truth = Truth(mesh_named(name), a, b)
    assert found.verdict in (SearchVerdict.FOUND, SearchVerdict.NEVER)
    until = min(found.time, 1.0)
    assert not any(truth.touch(t) for t in np.linspace(0, until, 300, endpoint=False) if t < until)
    if found.verdict == SearchVerdict.FOUND:
        assert not any(truth.touch(t) for t in until - np.geomspace(1e-9, 1e-3, 20) if t >= 0)
        if found.time > 0:
            assert truth.distance(found.time) <= 1.01e-7
        else:
            assert truth.touch(0.0) or truth.distance(0.0) <= 1.01e-7


@pytest.mark.slow
@settings(max_examples=examples(40))
@given(st.integers(0, 10**6), st.sampled_from(MESHES))
def test_surfaces_meet_no_earlier_than_their_hulls(seed, name):
    a, b = encounter(seed, 3.0, apart=(1.0, 1.5))
    hull = shape_named(name).hull
    hulls, surfaces = time_of_impact(hull, hull, a, b, 0.0, 3.0, 1e-9, COLD_START), impact(a, b, name, end=3.0)
    assert surfaces.time >= hulls.time - 1e-8
    assert surfaces.verdict <= hulls.verdict


@pytest.mark.parametrize("rate", [0.0, 5.0])
def test_a_cube_inside_a_hollow_one_strikes_the_wall_while_the_centres_part(rate):
    small, speed, start = 0.4, 0.2, 0.02
    a, b = body(), body((start, 0.01, 0.0), (speed, 0, 0), spin=(0, 0, rate), size=small)

    def gap(t):
        reach = small * WIDTH / 2 * (abs(np.cos(rate * t)) + abs(np.sin(rate * t)))
        return WIDTH / 2 - start - speed * t - reach

    times = np.linspace(0, 2, 200_001)
    after = np.argmax(gap(times) <= 0)
    expected = brentq(gap, times[after - 1], times[after], xtol=1e-14)
    found = impact(a, b, tolerance=1e-10)
    assert found.verdict == SearchVerdict.FOUND
    assert found.time == pytest.approx(expected, abs=1e-8)
    assert found.time <= expected
    assert impact(a, b, end=0.99 * expected).verdict == SearchVerdict.NEVER  # inside, and not touching


def test_surfaces_that_cross_at_the_beginning_touch_then_and_those_that_fly_apart_never_do():
    assert impact(body(), body((0.3, 0.1, 0.2)), begin=2.0)[:2] == (SearchVerdict.FOUND, 2.0)
    assert impact(body(), body((5, 0, 0), (1.0, 0, 0)))[:2] == (SearchVerdict.NEVER, np.inf)
    assert impact(body(), body((5, 0.1, 0), (-1.0, 0, 0)), end=2.0)[:2] == (SearchVerdict.NEVER, 2.0)
    assert impact(body(), body((5, 2.0, 0), (-1.0, 0, 0), spin=(1, 2, 3)))[:2] == (SearchVerdict.NEVER, np.inf)


def test_a_search_from_where_another_ended_finds_the_same():
    for seed in range(20):
        a, b = encounter(seed, 3.0, apart=(1.0, 1.5))
        first = impact(a, b, "pumpkin-1753.ply", end=3.0, tolerance=1e-8)
        again = impact(a, b, "pumpkin-1753.ply", end=3.0, tolerance=1e-8, start=first.warm_start)
        assert again.verdict == first.verdict
        assert again.time == pytest.approx(first.time, abs=1e-6)


def test_late_times_lose_no_more_digits_than_the_clock_has():
    late = 1e5
    a, b = body(spin=(0.3, 1, 2)), body((3, 0.2, 0.1), (-1.0, 0, 0), spin=(1, -2, 0))
    early = impact(a, b, tolerance=1e-9)
    earlier = [m._replace(position=place(m, -late), quaternion=attitude(m, -late)) for m in (a, b)]
    found = impact(*earlier, begin=late, tolerance=1e-9)
    assert found.verdict == SearchVerdict.FOUND
    assert found.time - late == pytest.approx(early.time, abs=1e-8)


@pytest.mark.parametrize("name", ["pumpkin-1753.ply", "package:pybullet_data/duck.obj"])
@pytest.mark.parametrize("spin", [0.0, 3.0, 10.0])
def test_windows_of_few_triangles_find_the_impact_that_a_search_through_the_trees_finds(name, spin):
    shape, tolerance = shape_named(name), 1e-9
    for seed in range(15):
        a, b = encounter(seed, spin, apart=(1.0, 1.5))
        found = impact(a, b, name, end=2.0, tolerance=tolerance)
        one, other = seen_at(a, b, 0.0)
        through = first_touch(Trees(shape.tree, shape.tree), one, other, 0.0, 2.0, tolerance, NO_NODES)
        assert found.verdict == through.verdict
        if found.verdict == SearchVerdict.FOUND:
            assert found.time == pytest.approx(through.time, abs=1e-11)
