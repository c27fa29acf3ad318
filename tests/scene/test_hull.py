import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from harness.errors import InputError
from harness.scene.hull import convex_hull
from harness.scene.topology import topology, volume
from tests.conftest import examples


def assert_fit_for_fcl(points, hull):
    """Closed, counter-clockwise seen from outside, around all points, and of its own vertices only."""
    about = topology(hull.faces, len(hull.vertices))
    assert about.watertight
    assert about.turned == 0
    assert np.array_equal(np.unique(hull.faces), np.arange(len(hull.vertices)))
    a, b, c = (hull.vertices[hull.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    solid = lengths > 1e-9 * lengths.max()
    heights = (points @ normals[solid].T - np.einsum("ij,ij->i", normals, a)[solid]) / lengths[solid]
    assert heights.max() < 1e-9 * np.ptp(points)


@given(hnp.arrays(np.float64, st.tuples(st.integers(4, 40), st.just(3)), elements=st.integers(-4, 4)))
@settings(max_examples=examples(100), deadline=None)
def test_a_hull_is_closed_and_outward_also_of_points_on_planes_and_lines(points):
    try:
        hull = convex_hull(points)
    except InputError:
        assert np.linalg.matrix_rank(points - points[0]) < 3
    else:
        assert_fit_for_fcl(points, hull)


def test_only_corners_are_left_of_a_finely_divided_cube():
    cube = trimesh.creation.box().subdivide().subdivide().subdivide()
    hull = convex_hull(cube.vertices)
    assert (len(hull.vertices), len(hull.faces)) == (8, 12)
    assert volume(hull.vertices, hull.faces) == pytest.approx(1)


@pytest.mark.slow
def test_all_vertices_of_an_icosphere_are_on_its_hull():
    sphere = trimesh.creation.icosphere(4)
    hull = convex_hull(sphere.vertices)
    assert (len(hull.vertices), len(hull.faces)) == (2562, 5120)
    assert_fit_for_fcl(sphere.vertices, hull)


def test_its_arrays_cannot_be_written():
    hull = convex_hull(trimesh.creation.box().vertices)
    for array in (hull.vertices, hull.faces):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
