"""Bodies deep in each other: the field of distances against closed forms, and how long they touch against FCL."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.narrowphase.clearance_field import NODES, clearance_field, distance_from
from harness.narrowphase.free_flight import relative_motion, seen_at
from harness.narrowphase.immersion_duration import clearance, immersion_lasts
from harness.narrowphase.triangle_tree import triangle_tree
from tests.conftest import cube_mesh, slow_beyond
from tests.narrowphase.flights import Truth, body, encounter, shape_named
from tests.narrowphase.meshes import MESHES, mesh_named

WIDTH = 1 / np.sqrt(3)
PITCH = 1.0 / (NODES - 1)


def lasts(name, a, b, name_b=None):
    one, other = shape_named(name), shape_named(name_b or name)
    a, b = seen_at(a, b, 0.0)
    return immersion_lasts(one.field, other.field, a.reach, b.reach, relative_motion(a, b, 0.0))


def test_clearance_in_a_cube_is_no_more_than_the_distance_from_its_faces_and_hardly_less():
    field = clearance_field(cube_mesh())
    rng = np.random.default_rng(1)
    for point in rng.uniform(-0.6, 0.6, (2000, 3)):
        beyond = np.abs(point) - WIDTH / 2
        outside = np.linalg.norm(np.maximum(beyond, 0.0))
        distance = -beyond.max() if beyond.max() < 0 else -outside
        found = clearance(field, tuple(point))
        assert abs(found) <= abs(distance)
        assert found == 0.0 or (found > 0) == (distance > 0)
        if np.abs(point).max() < 0.5:
            assert abs(found) >= abs(distance) - np.sqrt(3) * PITCH - 1e-5


# the teddy is in several pieces, and has no field
@pytest.mark.parametrize("name", slow_beyond(MESHES[:3]))
def test_clearance_is_no_more_than_the_distance_from_the_nearest_triangle(name):
    mesh = mesh_named(name)
    field, tree = shape_named(name).field, triangle_tree(mesh.vertices, mesh.faces)
    assert len(field.points)
    for point in np.random.default_rng(2).uniform(-0.5, 0.5, (500, 3)):
        assert abs(clearance(field, tuple(point))) <= distance_from(tree, tuple(point), np.inf)


def test_a_surface_that_is_partly_inside_out_has_no_field_and_proves_nothing():
    cube = cube_mesh()
    faces = cube.faces.copy()
    faces[0] = faces[0][::-1]
    assert len(clearance_field(replace(cube, faces=faces)).values) == 0


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(MESHES), st.sampled_from([0.0, 3.0, 10.0]))
def test_surfaces_touch_for_as_long_as_is_proved(seed, name, spin):
    a, b = encounter(seed, spin, apart=(0.0, 0.9))
    time = lasts(name, a, b)
    truth = Truth(mesh_named(name), a, b)
    for instant in np.linspace(0.0, min(time, 10.0), 12) if time > 0.0 else ():
        assert truth.touch(instant)


def test_deep_bodies_are_proved_to_touch_for_long_and_shallow_or_contained_ones_not_at_all():
    still, moving = body(), body((0.3, 0.2, 0.2), (1.0, 0.0, 0.0))
    assert 0.05 < lasts("cube", still, moving) < WIDTH - 0.3
    assert lasts("cube", still, body((WIDTH - 1e-3, 0.05, 0.02), (1.0, 0.0, 0.0))) == 0.0
    assert lasts("cube", still, body((0.01, 0.0, 0.0), (1.0, 0.0, 0.0), size=0.3)) == 0.0
    assert lasts("cube", still, body((0.3, 0.2, 0.2))) == np.inf
