from itertools import combinations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.optimize import nnls

from harness.scene.bounding_sphere import bounding_sphere


def by_brute_force(points):
    """The smallest of the spheres through 2, 3 or 4 of the points, of those around all of them."""
    best = np.inf
    for size in (2, 3, 4):
        for chosen in combinations(range(len(points)), size):
            corners = points[list(chosen)]
            edges = corners[1:] - corners[0]
            weights = np.linalg.lstsq(edges @ edges.T, (edges**2).sum(axis=1) / 2, rcond=None)[0]
            best = min(best, np.linalg.norm(points - corners[0] - weights @ edges, axis=1).max())
    return best


def assert_minimal(points, centre, radius):
    """The centre lies between points on the sphere: whichever way it moves, one of them gets further away."""
    distances = np.linalg.norm(points - centre, axis=1)
    assert distances.max() <= radius * (1 + 1e-12)
    touching = (points[distances >= radius * (1 - 1e-9)] - centre) / radius
    _, residual = nnls(np.vstack([touching.T, np.ones(len(touching))]), np.array([0.0, 0.0, 0.0, 1.0]))
    assert residual < 1e-6


coordinates = st.floats(-1, 1).map(lambda x: round(x, 9))


@pytest.mark.slow
@given(hnp.arrays(np.float64, st.tuples(st.integers(2, 7), st.just(3)), elements=coordinates))
@settings(max_examples=60, deadline=None)
def test_no_sphere_through_a_few_of_the_points_is_smaller(points):
    centre, radius = bounding_sphere(points)
    assert radius == pytest.approx(by_brute_force(points), rel=1e-7, abs=1e-9)
    assert np.linalg.norm(points - centre, axis=1).max() <= radius * (1 + 1e-12)


@pytest.mark.parametrize("squeeze", [1.0, 1e-3, 1e-7])
def test_points_on_the_sphere_prove_that_it_is_minimal(squeeze):
    rng = np.random.default_rng(1)
    for count in (2, 3, 5, 20, 1000):
        points = rng.normal(size=(count, 3)) * [1, 1, squeeze]
        assert_minimal(points, *bounding_sphere(points))


def test_known_spheres():
    cube = np.array(np.meshgrid(*[[0.0, 2.0]] * 3)).reshape(3, -1).T
    for points, centre, radius in (
        (cube, [1, 1, 1], np.sqrt(3)),
        (cube[:1], cube[0], 0),
        (np.array([[0.0, 0, 0], [4, 0, 0], [2, 1, 0]]), [2, 0, 0], 2),  # obtuse: two points determine it
        (np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]]), [1 / 3] * 3, np.sqrt(2 / 3)),
        (trimesh.creation.icosphere(3, radius=7).vertices + 5, [5, 5, 5], 7),
    ):
        found, size = bounding_sphere(np.asarray(points))
        np.testing.assert_allclose(found, centre, atol=1e-12)
        assert size == pytest.approx(radius, rel=1e-13)


def test_ten_thousand_points_on_one_sphere_are_no_special_case():
    turn = trimesh.transformations.random_rotation_matrix(np.array([0.1, 0.7, 0.3]))[:3, :3]
    points = trimesh.creation.icosphere(5).vertices @ turn
    centre, radius = bounding_sphere(points)
    np.testing.assert_allclose(centre, 0, atol=1e-12)
    assert radius == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("scale", [1e-90, 1e90])
def test_the_unit_of_length_does_not_matter(scale):
    points = np.random.default_rng(2).normal(size=(100, 3))
    centre, radius = bounding_sphere(points)
    far_centre, far_radius = bounding_sphere(points * scale)
    np.testing.assert_allclose(far_centre, centre * scale, rtol=1e-10)
    assert far_radius == pytest.approx(radius * scale, rel=1e-12)
