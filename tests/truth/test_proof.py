"""Proofs of impacts, held against closed forms, fractions, FCL and the engine."""

from math import acos, inf, sqrt

import fcl
import numpy as np
import pytest

import harness
from harness.scene.mesh import Surface
from harness.truth.cases import Cases
from harness.truth.flights import Flights
from harness.truth.parts import surface_parts
from harness.truth.proof import prove
from harness.truth.solids import Solids
from harness.truth.touch import BITS, _spin_quaternion
from harness.truth.vectors import rotations, turned
from tests.truth.pairs import CUBE, SOLIDS, around, case, flight

MESH, HULL, SPHERE = 0, 1, 2


def reason(first, second, lower, upper, window=10.0):
    return prove(case(first, second, lower, upper, window), SOLIDS)[0]


def sphere_pair(spin):
    # centres 3 apart, aside by 0.6, radii 0.5 each: they touch when the way along is 0.8, after 2.2 m at 2 m/s
    one = flight(SPHERE, spin=(0, 0, spin))
    return one, flight(SPHERE, position=(3, 0.6, 0), velocity=(-2, 0, 0), spin=(3, 4, 5)), (3 - sqrt(1 - 0.36)) / 2


def face_pair(solid, spin=0.0):
    # faces 2 m apart close at 1 m/s; spin about their normal changes nothing of it
    one = flight(solid, spin=(spin, 0, 0))
    return one, flight(solid, position=(3, 0.25, 0.125), velocity=(-1, 0, 0), spin=(-spin, 0, 0)), 2.0


def turning_pair(solid):
    # a cube that spins about z at 3 rad/s turns an edge, sqrt(1/2) from its axis, against a face at x = 0.65
    one = flight(solid, spin=(0, 0, 3.0))
    angle = np.pi / 4 - acos(0.65 / sqrt(0.5))
    return one, flight(solid, size=2.0, position=(1.65, 0, 0)), angle / 3.0


CLOSED_FORMS = [
    sphere_pair(5),
    *(
        pytest.param(*pair, marks=pytest.mark.slow)
        for pair in (
            sphere_pair(100),
            face_pair(HULL),
            face_pair(MESH),
            face_pair(MESH, spin=7.0),
            turning_pair(MESH),
            turning_pair(HULL),
        )
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("first", "second", "time"), CLOSED_FORMS)
def test_a_bracket_around_the_closed_form_is_proven_and_one_beside_it_is_refused(first, second, time):
    assert reason(first, second, *around(time)) == ""
    assert "not proven apart" in reason(first, second, *around(time + 1e-6))
    assert "not proven to touch" in reason(first, second, *around(time - 1e-6))


@pytest.mark.slow
@pytest.mark.parametrize(("first", "second", "time"), CLOSED_FORMS)
def test_that_they_never_touch_is_refused(first, second, time):
    assert "not proven apart" in reason(first, second, 10.0, inf)


def test_bounds_that_are_out_of_order_too_wide_or_say_never_of_a_part_are_refused():
    first, second, time = face_pair(MESH)
    assert "in order" in reason(first, second, time + 1e-10, time - 1e-10)
    assert "apart" in reason(first, second, time - 1e-8, time + 1e-10)
    assert "a part of the window" in reason(first, second, 1.0, inf)
    assert reason(first, second, 1.0, inf, window=1.0) == ""


@pytest.mark.slow
def test_what_passes_at_a_thousandth_of_a_size_is_proven_to():
    one = flight(MESH, spin=(0, 0, 3.0))  # its edges reach sqrt(1/2) from the axis
    for gap, proven in ((1e-3, True), (1e-6, True), (-1e-6, False)):
        other = flight(MESH, position=(sqrt(0.5) + 0.5 + gap, -4, 0), velocity=(0, 1, 0))
        assert (reason(one, other, 8.0, inf, window=8.0) == "") == proven


def test_faces_that_only_just_touch_at_the_start_are_proven_to_in_fractions():
    one = flight(MESH, spin=(1, 2, 3))
    for x, proven in ((1.0, True), (1.0 + 2**-52, False), (1.0 - 2**-53, True)):
        other = flight(MESH, position=(x, 0.25, 0.25), spin=(4, 5, 6))
        assert (reason(one, other, 0.0, 0.0) == "") == proven


def test_of_hulls_one_inside_the_other_nothing_is_proven_and_of_surfaces_that_they_do_not_touch():
    inside = {"size": 0.25, "spin": (1.0, 1.0, 0.0)}
    assert "may hold the other" in reason(flight(HULL), flight(HULL, **inside), 10.0, inf)
    assert reason(flight(MESH), flight(MESH, **inside), 10.0, inf) == ""


def test_the_turn_in_integers_is_that_of_doubles_to_within_what_is_allowed_for():
    rng = np.random.default_rng(1)
    for rate, time in ((1.0, 1.0), (30.0, 3.0), (1000.0, 2.0), (1e-9, 1.0)):
        spin = rate * rng.normal(size=3)
        w, x, y, z = (part / (1 << BITS) for part in _spin_quaternion(spin.tolist(), time))
        in_doubles = rotations(np.array([[1.0], [0], [0], [0]]), spin[:, None], np.array([time]))
        point = rng.normal(size=(3, 1))
        axis = np.array([x, y, z])
        across = 2.0 * np.cross(axis, point[:, 0])
        exactly = point[:, 0] + w * across + np.cross(axis, across)
        allowed = 2.0**-53 * np.linalg.norm(point) * (500 + 32 * np.linalg.norm(spin) * time)
        assert np.abs(turned(in_doubles, point)[:, 0] - exactly).max() < allowed


@pytest.mark.slow
def test_every_triangle_is_inside_of_the_parts_above_it_and_in_one_leaf():
    mesh = harness.Body("icosphere-1280.ply").mesh
    parts = surface_parts(mesh.vertices, mesh.faces)
    assert sorted(parts.leaves[parts.leaves >= 0]) == list(range(len(mesh.faces)))

    def below(node):
        if parts.leaves[node] >= 0:
            return [int(parts.leaves[node])]
        return below(parts.left[node]) + below(parts.right[node])

    for node in range(len(parts.radii)):
        away = mesh.vertices[mesh.faces[below(node)]].reshape(-1, 3) - parts.centres[:, node]
        assert np.linalg.norm(away, axis=1).max() <= parts.radii[node]
        assert np.abs(away @ parts.normals[:, node]).max() <= parts.halves[node]


@pytest.fixture(scope="module")
def pumpkins():
    """Ten pairs of spinning pumpkins, the engine's times, and the cases with bounds around them."""
    mesh = harness.Body("pumpkin-1753.ply").mesh
    rng = np.random.default_rng(7)

    def directions(dimensions):
        vectors = rng.normal(size=(10, dimensions))
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)

    def side(positions, velocities):
        return Flights(np.zeros(10, int), np.ones(10), positions, directions(4), velocities, 5.0 * directions(3))

    way = directions(3)
    first, second = side(np.zeros((10, 3)), np.zeros((10, 3))), side(2.0 * way, 0.3 * directions(3) - way)
    bodies = [harness.Body(mesh, s.positions, s.quaternions, 1.0, s.velocities, s.spins) for s in (first, second)]
    times = harness.time_of_impact(*bodies, until=4.0, tolerance=1e-12)
    touch = np.isfinite(times)
    cases = Cases(
        np.full(10, "random"),
        first,
        second,
        np.full(10, 4.0),
        np.where(touch, times - 4e-10, 4.0),
        np.where(touch, times + 5e-10, np.inf),
    )
    return mesh, cases, Solids({"pumpkin": Surface(mesh.vertices, mesh.faces)}, [("pumpkin", "mesh")])


@pytest.mark.slow
def test_the_engines_times_of_spinning_pumpkins_are_proven_and_shifted_ones_are_refused(pumpkins):
    _, cases, solids = pumpkins
    touch = np.flatnonzero(np.isfinite(cases.upper))
    assert len(touch) > 5
    assert prove(cases, solids) == [""] * 10
    hits = cases.some(touch)
    for shift in (1e-6, -1e-6):
        assert all(prove(hits._replace(lower=hits.lower + shift, upper=hits.upper + shift), solids))
    assert all(prove(hits._replace(lower=hits.windows, upper=np.full(len(touch), np.inf)), solids))


def test_fcl_sees_nothing_just_before_the_bracket_and_a_collision_just_after(pumpkins):
    mesh, cases, _ = pumpkins
    geometry = fcl.BVHModel()
    geometry.beginModel(len(mesh.faces), len(mesh.vertices))
    geometry.addSubModel(mesh.vertices, mesh.faces)
    geometry.endModel()

    def collide(place, time):
        objects = []
        for side in (cases.first, cases.second):
            quaternion = side.quaternions[place][:, None]
            turn = rotations(quaternion, side.spins[place][:, None], np.array([time]))[:, :, 0]
            position = side.positions[place] + time * side.velocities[place]
            objects.append(fcl.CollisionObject(geometry, fcl.Transform(turn, position)))
        return bool(fcl.collide(*objects, fcl.CollisionRequest(), fcl.CollisionResult()))

    for place in np.flatnonzero(np.isfinite(cases.upper)):
        assert not collide(place, cases.lower[place] - 1e-9)
        assert collide(place, cases.upper[place] + 1e-9)


def test_the_hull_of_a_cube_is_the_cube():
    assert len(SOLIDS.all[HULL].surface.vertices) == len(CUBE.vertices)
