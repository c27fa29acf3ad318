"""How far triangles are apart, by closed forms over arrays: the nearest of vertex and face, and of edge and edge.

Nothing is shared with the searches of the narrow phase. The nearest points bound a distance from above; the plane
through their middle, at whose sides the corners lie, bounds it from below. Closed forms are those of Ericson,
"Real-Time Collision Detection", 2005, 5.1.5 (point and triangle) and 5.1.9 (two segments).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Flags, Floats

_EDGES = ((0, 1), (1, 2), (2, 0))


class TriangleGaps(NamedTuple):
    """Of k pairs of triangles.

    Attributes
    ----------
    lower, upper : (k,) float arrays, m; both 0 where they cross
    points : (k, 2, 3) float array, m, `upper` apart
    """

    lower: Floats
    upper: Floats
    points: Floats


def triangle_gaps(one: Floats, other: Floats) -> TriangleGaps:
    """The distances of pairs of triangles.

    Parameters
    ----------
    one, other : (k, 3, 3) float arrays, corners, m
    """
    candidates = []
    for corner in range(3):
        mine, theirs = one[:, corner], other[:, corner]
        candidates.append((mine, nearest_on_triangle(mine, other)))
        candidates.append((nearest_on_triangle(theirs, one), theirs))
    for p, q in _EDGES:
        for r, s in _EDGES:
            candidates.append(_nearest_of_segments(one[:, p], one[:, q], other[:, r], other[:, s]))
    upper, points = np.full(len(one), np.inf), np.zeros((len(one), 2, 3))
    for here, there in candidates:
        distance = np.linalg.norm(here - there, axis=1)
        nearer = distance < upper  # never of what is not a number, of a triangle without area
        upper[nearer] = distance[nearer]
        points[nearer, 0], points[nearer, 1] = here[nearer], there[nearer]
    crossing = np.zeros(len(one), np.bool_)
    for p, q in _EDGES:
        crossing |= _pierces(one[:, p], one[:, q], other) | _pierces(other[:, p], other[:, q], one)
    upper[crossing] = 0.0
    return TriangleGaps(_apart_along(points, one, other, upper), upper, points)


def nearest_on_triangle(point: Floats, triangle: Floats) -> Floats:
    """(k, 3) m: the points of triangles (k, 3, 3) nearest to points (k, 3); not a number for some without area."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    ab, ac = b - a, c - a
    d1, d2 = _dot(ab, point - a), _dot(ac, point - a)
    d3, d4 = _dot(ab, point - b), _dot(ac, point - b)
    d5, d6 = _dot(ab, point - c), _dot(ac, point - c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        on_ab = a + (d1 / (d1 - d3))[:, None] * ab
        on_ac = a + (d2 / (d2 - d6))[:, None] * ac
        on_bc = b + ((d4 - d3) / ((d4 - d3) + (d5 - d6)))[:, None] * (c - b)
        inside = a + (vb / (va + vb + vc))[:, None] * ab + (vc / (va + vb + vc))[:, None] * ac
    regions = [
        (d1 <= 0.0) & (d2 <= 0.0),
        (d3 >= 0.0) & (d4 <= d3),
        (d6 >= 0.0) & (d5 <= d6),
        (vc <= 0.0) & (d1 >= 0.0) & (d3 <= 0.0),
        (vb <= 0.0) & (d2 >= 0.0) & (d6 <= 0.0),
        (va <= 0.0) & (d4 - d3 >= 0.0) & (d5 - d6 >= 0.0),
    ]
    found: Floats = np.select([region[:, None] for region in regions], [a, b, c, on_ab, on_ac, on_bc], inside)
    return found


def _nearest_of_segments(p: Floats, p_end: Floats, q: Floats, q_end: Floats) -> tuple[Floats, Floats]:
    """The points of segments (k, 3) nearest to each other."""
    along, across, between = p_end - p, q_end - q, p - q
    a, e, f = _dot(along, along), _dot(across, across), _dot(across, between)
    b, c = _dot(along, across), _dot(along, between)
    with np.errstate(divide="ignore", invalid="ignore"):
        slant = a * e - b * b
        s = np.where(slant > 0.0, np.clip((b * f - c * e) / slant, 0.0, 1.0), 0.0)
        t = (b * s + f) / e
        s = np.where(t < 0.0, np.clip(-c / a, 0.0, 1.0), np.where(t > 1.0, np.clip((b - c) / a, 0.0, 1.0), s))
    t = np.clip(t, 0.0, 1.0)
    return p + s[:, None] * along, q + t[:, None] * across


def _pierces(start: Floats, end: Floats, triangle: Floats) -> Flags:
    """(k,) bool array: whether a segment passes through the inside of a triangle."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    normal = np.cross(b - a, c - a)
    above, below = _dot(normal, start - a), _dot(normal, end - a)
    way = end - start
    sides = [_dot(way, np.cross(p - start, q - start)) for p, q in ((a, b), (b, c), (c, a))]
    same = np.all([side > 0.0 for side in sides], axis=0) | np.all([side < 0.0 for side in sides], axis=0)
    pierced: Flags = (above * below < 0.0) & same
    return pierced


def _apart_along(points: Floats, one: Floats, other: Floats, upper: Floats) -> Floats:
    """How far triangles are apart along the line through two points; 0 if they are not."""
    axis = (points[:, 1] - points[:, 0]) / np.where(upper > 0.0, upper, 1.0)[:, None]
    low = np.einsum("kcd,kd->kc", other, axis).min(axis=1) - np.einsum("kcd,kd->kc", one, axis).max(axis=1)
    lower: Floats = np.where(upper > 0.0, np.clip(low, 0.0, upper), 0.0)
    return lower


def _dot(a: Floats, b: Floats) -> Floats:
    product: Floats = np.einsum("kd,kd->k", a, b)
    return product
