"""Times of impact of surfaces: closed forms, spheres in the limit, hulls, and FCL at tiny steps."""

from functools import cache

import fcl
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from harness.narrowphase.advancement import IMPACT, NEVER, Motion, orientation, place, time_of_impact
from harness.narrowphase.gjk import NO_SEEDS
from harness.narrowphase.mesh_advancement import NO_START, MeshShape, mesh_shape, time_of_mesh_impact
from harness.narrowphase.support import support_map
from harness.narrowphase.triangle_tree import triangle_tree
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import MESHES, mesh_named, turns

STRAIGHT = (1.0, 0.0, 0.0, 0.0)
WIDTH = 1 / np.sqrt(3)


@cache
def shape_named(name):
    return mesh_shape(cube_mesh() if name == "cube" else mesh_named(name))


def body(position=(0, 0, 0), velocity=(0, 0, 0), quaternion=STRAIGHT, spin=(0, 0, 0), size=1.0):
    vectors = [tuple(map(float, v)) for v in (position, velocity, quaternion, spin)]
    return Motion(*vectors, float(size), size / 2)


def impact(a, b, name="cube", begin=0.0, end=np.inf, tolerance=1e-9, start=NO_START):
    shape = shape_named(name) if isinstance(name, str) else name
    return time_of_mesh_impact(shape, shape, a, b, begin, float(end), tolerance, start)


class Truth:
    """FCL on the surfaces, wherever the bodies are at a time."""

    def __init__(self, mesh, a, b):
        self._bodies = []
        for motion in (a, b):
            surface = fcl.BVHModel()
            surface.beginModel(len(mesh.vertices), len(mesh.faces))
            surface.addSubModel(mesh.vertices * motion.size, mesh.faces)
            surface.endModel()
            self._bodies.append((motion, fcl.CollisionObject(surface)))

    def _placed(self, time):
        for motion, placed in self._bodies:
            placed.setTransform(fcl.Transform(np.array(orientation(motion, time)), np.array(place(motion, time))))
        return self._bodies[0][1], self._bodies[1][1]

    def touch(self, time):
        return fcl.collide(*self._placed(time), fcl.CollisionRequest(), fcl.CollisionResult()) > 0

    def distance(self, time):
        return fcl.distance(*self._placed(time), fcl.DistanceRequest(), fcl.DistanceResult())


def encounter(seed, spin, apart=(0.7, 1.4)):
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.5, 1.5, 2).round(1)
    offset = rng.normal(size=3)
    offset *= sizes.sum() / 2 * rng.uniform(*apart) / np.linalg.norm(offset)
    drift = rng.normal(size=3)
    aim = drift - offset * rng.uniform(0.5, 2) + rng.normal(size=3) * 0.3
    q = turns(rng, 2)
    a = body((3, -2, 1), drift, q[0], rng.normal(size=3) * spin, sizes[0])
    return a, body(offset + np.array((3, -2, 1)), aim, q[1], rng.normal(size=3) * spin, sizes[1])


def test_cubes_that_meet_face_to_face_edge_to_face_and_corner_to_face_do_so_on_time():
    slanted = (np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8))
    tilt = np.arccos(1 / np.sqrt(3)) / 2  # a space diagonal turned on to the x axis
    on_corner = (np.cos(tilt), 0, np.sin(tilt) / np.sqrt(2), -np.sin(tilt) / np.sqrt(2))
    for quaternion, reach in ((STRAIGHT, WIDTH / 2), (slanted, WIDTH / np.sqrt(2)), (on_corner, 0.5)):
        found = impact(body(), body((5, 0.1, 0.07), (-2.0, 0, 0), quaternion))
        assert found.verdict == IMPACT
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
        shape = MeshShape(support_map(vertices), triangle_tree(vertices, np.array(sphere.faces, np.int32)), 0.5)
        found = []
        for q, p in zip(turns(np.random.default_rng(0), 20), turns(np.random.default_rng(1), 20), strict=True):
            a, b_ = body(quaternion=q, spin=(0.5, 1, 2)), body(offset, velocity, quaternion=p, spin=(1, -2, 0))
            found.append(impact(a, b_, shape, tolerance=1e-10).time - exact)
            hulls = time_of_impact(shape.hull, shape.hull, a, b_, 0.0, np.inf, 1e-10, NO_SEEDS)
            assert found[-1] == pytest.approx(hulls.time - exact, abs=1e-8)  # a convex surface is its hull
        assert min(found) > -1e-9  # inscribed, so they meet later
        errors.append(np.mean(found))
        lengths.append(sphere.edges_unique_length.mean())
    orders = np.diff(np.log(errors)) / np.diff(np.log(lengths))
    assert (abs(orders - 2) < 0.35).all()


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(MESHES), st.sampled_from([0.0, 3.0, 15.0]))
def test_nothing_touches_before_an_impact_and_at_it_the_gap_is_within_tolerance(seed, name, spin):
    a, b = encounter(seed, spin)
    found = impact(a, b, name, end=1.0, tolerance=1e-7)
    truth = Truth(mesh_named(name), a, b)
    assert found.verdict in (IMPACT, NEVER)
    until = min(found.time, 1.0)
    assert not any(truth.touch(t) for t in np.linspace(0, until, 300, endpoint=False) if t < until)
    if found.verdict == IMPACT:
        assert not any(truth.touch(t) for t in until - np.geomspace(1e-9, 1e-3, 20) if t >= 0)
        if found.time > 0:
            assert truth.distance(found.time) <= 1.01e-7
        else:
            assert truth.touch(0.0) or truth.distance(0.0) <= 1.01e-7


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(MESHES))
def test_surfaces_meet_no_earlier_than_their_hulls(seed, name):
    a, b = encounter(seed, 3.0, apart=(1.0, 1.5))
    hull = shape_named(name).hull
    hulls, surfaces = time_of_impact(hull, hull, a, b, 0.0, 3.0, 1e-9, NO_SEEDS), impact(a, b, name, end=3.0)
    assert surfaces.time >= hulls.time - 1e-8
    assert surfaces.verdict <= hulls.verdict
