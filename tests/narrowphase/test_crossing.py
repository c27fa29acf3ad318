"""Triangles and surfaces: proofs that they touch or not, against exact arithmetic and against FCL."""

from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.backends.fcl import Fcl
from harness.narrowphase.crossing import meeting
from harness.narrowphase.mesh_pairs import MeshPairs
from harness.narrowphase.placement import Places
from harness.narrowphase.triangle_tree import triangle_tree
from harness.narrowphase.verdicts import PairVerdict, which
from tests.conftest import cube_mesh, slow_beyond
from tests.narrowphase.meshes import MESHES, crowd, mesh_named


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def edges(triangle):
    return [[y - x for x, y in zip(triangle[k - 1], triangle[k], strict=True)] for k in range(3)]


def touch_exactly(one, other):
    """By separating axes in rational arithmetic; the edges in the planes decide where both are coplanar."""
    one, other = ([[Fraction(float(x)) for x in corner] for corner in triangle] for triangle in (one, other))
    normals = [cross(edges(t)[0], edges(t)[1]) for t in (one, other)]
    axes = normals + [cross(a, b) for a, b in product(edges(one), edges(other))]
    axes += [cross(n, e) for n, t in zip(normals, (one, other), strict=True) for e in edges(t)]
    for axis in axes:
        here, there = [dot(axis, c) for c in one], [dot(axis, c) for c in other]
        if max(here) < min(there) or max(there) < min(here):
            return False
    return True


def triangles(seed, near, thin):
    rng = np.random.default_rng(seed)
    pair = rng.normal(size=(2, 3, 3))
    pair[:, 2] = pair[:, 0] + (pair[:, 1] - pair[:, 0]) * rng.uniform() + (pair[:, 2] - pair[:, 0]) * thin
    if near == "vertex on face":
        pair[1, 0] = rng.dirichlet([1, 1, 1]) @ pair[0]
    elif near == "edge on edge":
        at = (pair[0, 0] + pair[0, 1]) / 2
        pair[1, 1] = 2 * at - pair[1, 0]
    elif near == "coplanar":
        pair[1] = rng.normal(size=(3, 3)) @ np.eye(3)
        pair[1] = pair[0, 0] + pair[1, :, :2] @ (pair[0, 1:] - pair[0, 0])
    return pair


@given(
    st.integers(0, 10**6),
    st.sampled_from(["", "vertex on face", "edge on edge", "coplanar"]),
    st.sampled_from([1.0, 1e-3, 1e-8]),
    st.sampled_from([0.0, 1e-9, -1e-9, 1e-12]),
)
def test_a_verdict_on_triangles_is_that_of_exact_arithmetic(seed, near, thin, shift):
    one, other = triangles(seed, near, thin)
    other = other + shift
    said = meeting(tuple(map(tuple, one)), tuple(map(tuple, other)), 1e-13)
    assert meeting(tuple(map(tuple, other)), tuple(map(tuple, one)), 1e-13) == said
    assert said == PairVerdict.UNDECIDED or (said == PairVerdict.TOUCHING) == touch_exactly(one, other)


def test_triangles_in_general_position_are_nearly_all_decided():
    pairs = [[tuple(map(tuple, triangle)) for triangle in triangles(k, "", 1.0)] for k in range(2000)]
    assert not any(meeting(one, other, 1e-13) == PairVerdict.UNDECIDED for one, other in pairs)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [-1e-11, 1e-11])
def test_a_point_on_a_face_is_told_by_the_side_it_comes_from(gap):
    face = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))  # in integers, kernels would be compiled for it alone
    needle = ((0.2, 0.2, gap), (0.3, 0.2, 1.0), (0.2, 0.3, 1.0))
    assert meeting(face, needle, 1e-13) == (PairVerdict.SEPARATE if gap > 0 else PairVerdict.TOUCHING)


@pytest.mark.parametrize("name", slow_beyond(MESHES, 2))
def test_all_that_is_below_a_node_is_in_its_disc(name):
    mesh = mesh_named(name)
    tree = triangle_tree(mesh.vertices, mesh.faces)
    leaves = {}

    def below(node):
        if tree.right[node] < 0:
            leaves[node] = [-1 - tree.right[node]]
        else:
            assert tree.parent[node + 1] == tree.parent[tree.right[node]] == node
            leaves[node] = below(node + 1) + below(tree.right[node])
        return leaves[node]

    assert sorted(below(0)) == list(range(len(mesh.faces)))
    assert len(leaves) == len(tree.right)
    for node, triangles in leaves.items():
        if node % 7 == 0 or node < 20:
            *centre, radius, x, y, z, thickness = tree.discs[node]
            corners = tree.corners[triangles].reshape(-1, 3) - centre
            assert np.linalg.norm([x, y, z]) == pytest.approx(1.0, abs=1e-12)
            assert np.linalg.norm(corners, axis=1).max() <= radius
            assert np.abs(corners @ [x, y, z]).max() <= thickness


@pytest.mark.parametrize("name", slow_beyond([*MESHES, "icosphere-1280.ply"], 2))
def test_surfaces_are_judged_as_fcl_judges_them_and_nearly_always_judged(name):
    scene = crowd(mesh_named(name), "mesh", 30, 2.0, 1)
    brute = Fcl()
    brute.load(scene)
    touching = {tuple(p) for p in brute.pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()}
    pairs = np.array(list(combinations(range(30), 2)))
    placement = Places(scene.bodies.sizes).at(scene.bodies.positions, scene.bodies.quaternions)
    surfaces = MeshPairs(scene.meshes, scene.mesh_of)
    for _ in range(2):  # searched, then started where they crossed
        verdicts = surfaces.settle(pairs, placement)
        assert {tuple(p) for p in pairs[which(verdicts, PairVerdict.TOUCHING)].tolist()} <= touching
        assert not {tuple(p) for p in pairs[which(verdicts, PairVerdict.SEPARATE)].tolist()} & touching
        assert np.count_nonzero(which(verdicts, PairVerdict.UNDECIDED)) <= 2


def test_aligned_cubes_that_share_planes_are_left_to_fcl():
    mesh, width = cube_mesh(), 1 / np.sqrt(3)
    placement = Places(np.ones(2)).at(np.array([[0, 0, 0], [width, 0, 0]]), np.array([[1.0, 0, 0, 0]] * 2))
    assert MeshPairs([mesh], np.zeros(2, np.int64)).settle(np.array([[0, 1]]), placement).tolist() == [
        PairVerdict.UNDECIDED
    ]
