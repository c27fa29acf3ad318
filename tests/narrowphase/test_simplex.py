"""Nearest points of simplices, by the condition that tells them: no corner is nearer along them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.narrowphase.simplex import (
    depth_of_origin,
    nearest_on_segment,
    nearest_on_tetrahedron,
    nearest_on_triangle,
    weights,
)

NEAREST = {2: nearest_on_segment, 3: nearest_on_triangle, 4: nearest_on_tetrahedron}


def corners_of(count, seed, flatness, offset):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) * [1, 1, flatness] + rng.normal(size=3) * offset


@pytest.mark.parametrize("count", [2, 3])
@given(st.integers(0, 10**6), st.sampled_from([1.0, 1e-3, 0.0]), st.sampled_from([0.0, 0.3, 3.0]))
def test_no_corner_is_nearer_along_the_nearest_point(count, seed, flatness, offset):
    corners = corners_of(count, seed, flatness, offset)
    point, squared, kept = NEAREST[count](*map(tuple, corners))
    point = np.array(point)
    assert squared == pytest.approx(point @ point, rel=1e-15)
    assert ((corners - point) @ point >= -1e-12).all()
    carrying = corners[[bool(kept >> k & 1) for k in range(count)]]
    shares = np.array(weights(*map(tuple, np.resize(carrying, (3, 3))), len(carrying)))[: len(carrying)]
    assert (shares >= 0).all()
    assert np.allclose(shares @ carrying, point, atol=1e-9)


@given(st.integers(0, 10**6), st.sampled_from([1.0, 1e-3]), st.sampled_from([0.0, 0.3, 3.0]))
def test_a_tetrahedron_has_the_origin_inside_or_a_nearest_face(seed, flatness, offset):
    a, b, c, d = corners = corners_of(4, seed, flatness, offset)
    # as a search leaves it: the origin is not beyond the face opposite the last corner
    normal = np.cross(b - a, c - a)
    if (normal @ -a) * (normal @ (d - a)) <= 0.0:
        return
    point, _, kept = nearest_on_tetrahedron(*map(tuple, corners))
    radius = depth_of_origin(*map(tuple, corners))
    if kept == 15:
        inside = np.linalg.solve(np.vstack([corners.T, np.ones(4)]), [0, 0, 0, 1])
        assert (inside >= -1e-9).all()
        assert radius >= 0.0
        normals = [np.cross(q - p, r - p) for p, q, r in ((a, b, c), (a, b, d), (b, c, d), (a, c, d))]
        heights = [abs(n @ p) / np.linalg.norm(n) for n, p in zip(normals, (a, a, b, a), strict=True)]
        assert radius == pytest.approx(min(heights), rel=1e-6, abs=1e-12)
    else:
        assert radius <= 1e-12
        assert ((corners - np.array(point)) @ np.array(point) >= -1e-12).all()
