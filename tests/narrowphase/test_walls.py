"""Wall contacts against rotated vertices, computed independently."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from harness.narrowphase.support import support_map
from harness.narrowphase.walls import hulls_at_walls, spheres_at_walls
from tests.conftest import random_scene


@given(st.integers(0, 10_000), st.booleans())
def test_a_hull_touches_a_wall_when_a_vertex_reaches_it(seed, cull):
    scene = random_scene("hull", 6, 3.0, seed)
    bodies, half = scene.bodies, np.array([1.2, 1.3, 1.4])
    touching = np.empty((6, 6), bool)
    vertices = scene.mesh.hull.vertices
    hull = support_map(vertices)
    hulls_at_walls(bodies.positions, bodies.quaternions, bodies.sizes, hull, half, cull, touching)
    turned = Rotation.from_quat(bodies.quaternions[:, [1, 2, 3, 0]]).as_matrix()
    corners = np.einsum("nij,kj->nki", turned, vertices) + bodies.positions[:, None]
    assert (touching[:, 0::2] == (corners.min(axis=1) <= -half)).all()
    assert (touching[:, 1::2] == (corners.max(axis=1) >= half)).all()


def test_only_hulls_within_reach_of_a_wall_are_looked_at():
    scene = random_scene("hull", 50, 20.0)
    bodies, touching = scene.bodies, np.empty((50, 6), bool)
    near = (np.abs(bodies.positions) + 0.5 >= scene.box.half).any(axis=1).sum()
    hull = support_map(scene.mesh.hull.vertices)
    arguments = (bodies.positions, bodies.quaternions, bodies.sizes, hull, scene.box.half)
    assert hulls_at_walls(*arguments, True, touching) == near
    assert hulls_at_walls(*arguments, False, touching) == 50


def test_a_sphere_touches_a_wall_from_exactly_its_radius_on():
    positions = np.array([[4.5, 0, 0], [4.5 - 1e-12, 0, 0], [0, -4.5, 0], [0, 0, 7]])
    touching = np.empty((4, 6), bool)
    spheres_at_walls(positions, np.full(4, 0.5), np.full(3, 5.0), touching)
    assert np.argwhere(touching).tolist() == [[0, 1], [2, 2], [3, 5]]
