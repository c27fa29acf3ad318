"""Distances of triangles, degenerate ones too, by their edges and faces; surfaces within a distance, by FCL."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.narrowphase.free_flight import orientation, place
from harness.narrowphase.gjk import relative_pose
from harness.narrowphase.tree_pairs import DEPTH, NO_NODES, ROOTS, Trees
from harness.narrowphase.triangle_distance import triangle_distance
from harness.narrowphase.triangles_within import gap_of_leaves, triangles_within
from harness.narrowphase.vectors import minus
from tests.narrowphase.flights import Truth, encounter, shape_named
from tests.narrowphase.meshes import MESHES, mesh_named


def between_segments(p, q, r, s):
    """By the least over the four ends and the common perpendicular."""

    def to_segment(x, a, b):
        along = b - a
        length = along @ along
        part = np.clip((x - a) @ along / length, 0, 1) if length > 0 else 0.0
        return np.linalg.norm(x - a - part * along)

    best = min(to_segment(p, r, s), to_segment(q, r, s), to_segment(r, p, q), to_segment(s, p, q))
    u, v, w = q - p, s - r, p - r
    determinant = (u @ u) * (v @ v) - (u @ v) ** 2
    if determinant > 1e-14 * (u @ u) * (v @ v):
        on_first = ((u @ v) * (v @ w) - (v @ v) * (u @ w)) / determinant
        on_second = ((u @ u) * (v @ w) - (u @ v) * (u @ w)) / determinant
        if 0 <= on_first <= 1 and 0 <= on_second <= 1:
            best = min(best, np.linalg.norm(w + on_first * u - on_second * v))
    return best


def by_features(one, other):
    best = min(between_segments(one[i - 1], one[i], other[j - 1], other[j]) for i in range(3) for j in range(3))
    for face, points in ((one, other), (other, one)):
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        area = normal @ normal
        if area < 1e-24:
            continue

        def over(x, face=face, normal=normal):
            return all(np.cross(face[k] - face[k - 1], x - face[k - 1]) @ normal >= 0 for k in range(3))

        heights = (points - face[0]) @ normal
        for k in range(3):
            if over(points[k] - heights[k] / area * normal):
                best = min(best, abs(heights[k]) / np.sqrt(area))
            p, q, at_p, at_q = points[k - 1], points[k], heights[k - 1], heights[k]
            if at_p * at_q <= 0 and at_p != at_q and over(p + at_p / (at_p - at_q) * (q - p)):
                return 0.0
    return best


def as_tuples(triangle):
    return tuple(tuple(map(float, corner)) for corner in triangle)


@pytest.mark.slow
@settings(max_examples=300)
@given(
    st.integers(0, 10**6),
    st.sampled_from(["", "needle", "segment", "point", "above a face", "coplanar", "shifted", "far"]),
)
def test_the_distance_of_triangles_is_the_least_over_their_features(seed, form):
    rng = np.random.default_rng(seed)
    one, other = rng.normal(size=(2, 3, 3))
    if form == "needle":
        one[2] = one[0] + 1e-9 * rng.normal(size=3)
    elif form == "segment":
        one[2] = 0.3 * one[0] + 0.7 * one[1]
    elif form == "point":
        one[:] = one[0]
    elif form == "above a face":
        other += one.mean(axis=0) - other[0] + 1e-6 * np.cross(one[1] - one[0], one[2] - one[0])
    elif form == "coplanar":
        one[:, 2], other[:, 2] = 0, 1e-3
    elif form == "shifted":
        other = one + 1e-3 * rng.normal(size=3)
    elif form == "far":
        other = 0.01 * other + 5
    found, expected = triangle_distance(as_tuples(one), as_tuples(other), 1e-15), by_features(one, other)
    assert found.upper == pytest.approx(expected, abs=1e-12)
    assert found.lower == pytest.approx(expected, abs=1e-12)
    if expected > 0:
        assert np.linalg.norm(found.axis) == pytest.approx(1.0)
        apart = (one @ found.axis).min() - (other @ found.axis).max()
        assert apart == pytest.approx(found.lower, abs=1e-14)


@pytest.mark.slow
@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(["cube", *MESHES[:3]]))
def test_two_triangles_are_found_within_a_limit_exactly_where_fcl_finds_the_surfaces_so_near(seed, name):
    a, b = encounter(seed, 0.0, apart=(0.8, 1.5))
    tree = shape_named(name).tree
    offset = minus(place(b, 0.0), place(a, 0.0))
    pose = relative_pose(orientation(a, 0.0), a.size, orientation(b, 0.0), b.size, offset)
    trees, stack = Trees(tree, tree), np.empty((DEPTH, 2), np.int64)
    if name == "cube":
        expected = min(by_features(p, q) for p in placed(tree, a) for q in placed(tree, b))
    else:
        truth = Truth(mesh_named(name), a, b)
        expected = 0.0 if truth.touch(0.0) else truth.distance(0.0)
    found = triangles_within(trees, pose, 1.01 * expected + 1e-9, 1e-13, stack)
    assert expected - 1e-9 <= found.gap <= 1.01 * expected + 1e-9
    assert gap_of_leaves(trees, pose, found.leaves, 1e-13) == found.gap
    assert gap_of_leaves(trees, pose, ROOTS, 1e-13) == np.inf
    if expected > 0:
        assert triangles_within(trees, pose, 0.99 * expected, 1e-13, stack) == (np.inf, NO_NODES)


def placed(tree, motion):
    return tree.corners * motion.size @ np.array(orientation(motion, 0.0)).T + motion.position
