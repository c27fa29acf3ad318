"""How far two bodies are apart, bounded from both sides: by nearest points, and by planes between their parts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.reference.triangle_gaps import nearest_on_triangle, triangle_gaps
from harness.scene.mesh import Surface

# Pairs of triangles that are put to the closed forms at once, which bounds the memory.
_AT_ONCE = 200_000
# Relative to the coordinates: more than rounding can do to the distance of two boxes.
_ROUNDING = 1e-12


class GapBounds(NamedTuple):
    """Between which lengths (m) the gap of two bodies lies; both 0 where they touch."""

    lower: float
    upper: float


def sphere_bounds(offset: Floats, radius_a: float, radius_b: float) -> GapBounds:
    """The gap of two spheres whose centres are an offset (3,) m apart, up to rounding."""
    gap = float(max(np.longdouble(0.0), np.sqrt(np.square(offset.astype(np.longdouble)).sum()) - radius_a - radius_b))
    return GapBounds(gap, gap)


def surface_bounds(one: Surface, other: Surface, *, solid: bool) -> GapBounds:
    """The gap of two surfaces of triangles, of whose triangles those far from the other body are passed over.

    Parameters
    ----------
    one, other : in the same axes, m
    solid : whether they are convex and filled, so that one inside the other touches it
    """
    corners, other_corners = one.vertices[one.faces], other.vertices[other.faces]
    if solid and (_inside(one.vertices[:1], other_corners)[0] or _inside(other.vertices[:1], corners)[0]):
        return GapBounds(0.0, 0.0)
    from scipy.spatial import cKDTree  # which a plan need not wait for

    # the nearest vertices are no nearer than the surfaces
    upper = float(cKDTree(other.vertices).query(one.vertices)[0].min())
    slack = _ROUNDING * max(float(np.abs(one.vertices).max()), float(np.abs(other.vertices).max()))
    boxes, other_boxes = _boxes(corners), _boxes(other_corners)
    whole, other_whole = _boxes(one.vertices[None]), _boxes(other.vertices[None])
    some = np.flatnonzero(_apart(boxes, other_whole)[:, 0] <= upper + slack)
    others = np.flatnonzero(_apart(other_boxes, whole)[:, 0] <= upper + slack)
    lower = np.inf
    for rows in np.array_split(some, max(1, len(some) * len(others) // _AT_ONCE)):
        near = np.argwhere(_apart(boxes[rows], other_boxes[others]) <= upper + slack)
        found = triangle_gaps(corners[rows[near[:, 0]]], other_corners[others[near[:, 1]]])
        upper = min(upper, float(found.upper.min(initial=np.inf)))
        lower = min(lower, float(found.lower.min(initial=np.inf)))
        if upper == 0.0:
            return GapBounds(0.0, 0.0)
    return GapBounds(min(lower, upper), upper)


def off_surface(points: Floats, surface: Surface, *, solid: bool) -> Floats:
    """(k,) m: how far points (k, 3) are from a surface, or from what it encloses if it is convex and filled."""
    corners = surface.vertices[surface.faces]
    distances = np.empty(len(points))
    for k, point in enumerate(points):
        nearest = nearest_on_triangle(np.broadcast_to(point, (len(corners), 3)), corners)
        distances[k] = np.nanmin(np.linalg.norm(nearest - point, axis=1))
    if solid:
        distances[_inside(points, corners)] = 0.0
    return distances


def _boxes(corners: Floats) -> Floats:
    """(f, 2, 3): the low and the high corner of the box around each part."""
    return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)


def _apart(boxes: Floats, others: Floats) -> Floats:
    """(f, g) m: how far boxes are apart."""
    ways = np.maximum(boxes[:, None, 0] - others[None, :, 1], others[None, :, 0] - boxes[:, None, 1])
    distances: Floats = np.linalg.norm(np.maximum(ways, 0.0), axis=2)
    return distances


def _inside(points: Floats, corners: Floats) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(k,): whether points are behind every face of a convex surface, whichever way its faces are turned."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normals = np.cross(b - a, c - a)
    centre = corners.reshape(-1, 3).mean(axis=0)
    outward = np.where(np.einsum("fd,fd->f", normals, a - centre) < 0.0, -1.0, 1.0)
    normals = normals * outward[:, None]
    heights = points @ normals.T - np.einsum("fd,fd->f", normals, a)
    return np.asarray((heights <= 0.0).all(axis=1))
