"""The support map against a look at every vertex."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.kernel import kernel
from harness.narrowphase.support import support, support_map
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import MESHES, mesh_named


@kernel
def ask(hull, directions, answers):
    for k in range(len(directions)):
        answers[k] = support(hull, directions[k, 0], directions[k, 1], directions[k, 2])


def answers(vertices, directions):
    found = np.empty(len(directions), np.int64)
    ask(support_map(vertices), np.ascontiguousarray(directions, float), found)
    return found


def assert_farthest(vertices, directions):
    found = answers(vertices, directions)
    reach = directions @ vertices.T
    lengths = np.linalg.norm(directions, axis=1)
    assert (reach[np.arange(len(found)), found] >= reach.max(axis=1) - 1e-15 * lengths).all()


def special_directions():
    """Axes, diagonals and their neighbours, where cells meet; with zeros of both signs."""
    steps = np.array([-1.0, -1e-17, -0.0, 0.0, 1e-17, 0.5, 1.0])
    grid = np.stack(np.meshgrid(steps, steps, steps), -1).reshape(-1, 3)
    return grid[np.abs(grid).sum(axis=1) > 0.0]


@pytest.mark.parametrize("name", MESHES)
def test_no_vertex_of_a_hull_reaches_farther(name):
    vertices = mesh_named(name).hull.vertices
    random = np.random.default_rng(0).normal(size=(3000, 3))
    assert_farthest(vertices, np.concatenate([random, special_directions()]))


@given(st.integers(0, 10**6), st.integers(1, 60), st.sampled_from([0.0, 1e-13, 1e-6, 1.0]), st.integers(-300, 280))
def test_flat_clouds_doubled_points_and_any_length_of_direction_are_answered(seed, count, thickness, power):
    rng = np.random.default_rng(seed)
    vertices = rng.uniform(-0.5, 0.5, (count, 3)) * [1, 1, thickness]
    vertices = np.concatenate([vertices, vertices[: count // 2]])
    normals = (vertices - vertices[::-1])[np.abs(vertices - vertices[::-1]).sum(axis=1) > 1e-9]
    directions = np.concatenate([rng.normal(size=(50, 3)), normals, special_directions()])
    assert_farthest(vertices, directions)
    assert (answers(vertices, directions) == answers(vertices, directions * 2.0 ** (power / 2))).all() or power < -200


def test_a_query_compares_a_few_vertices_however_many_there_are():
    for name, most in (("cube.ply", 4), ("pumpkin-1753.ply", 10), ("pumpkin-17001.ply", 12)):
        hull = support_map((cube_mesh() if name == "cube.ply" else mesh_named(name)).hull.vertices)
        assert np.diff(hull.start).max() <= most
        assert np.diff(hull.start).min() >= 1


def test_a_direction_that_is_none_gets_some_vertex():
    found = answers(cube_mesh().hull.vertices, [[0, 0, 0], [np.nan, 1, 0], [np.inf, 0, 1], [0, -np.inf, np.nan]])
    assert ((found >= 0) & (found < 8)).all()
