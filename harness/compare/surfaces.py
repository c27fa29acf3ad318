"""Two triangle surfaces: which of their triangles share a point, exactly.

Floats only leave out triangles that are apart by more than floats can err; every pair that is left is decided by exact
arithmetic, so that the answer is as exact as if all pairs had been.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from harness.arrays import Floats, Ints
from harness.compare import certificate
from harness.compare.certificate import Certificate, Judgement, distance_along
from harness.compare.convex import CommonPoint, meet
from harness.compare.exact import PlacedPoints, world_points
from harness.scene.mesh import Surface

# By how much of the extent a float coordinate may err: many times what a rotation and a sum can lose.
_ROUNDING = 1e-13
# Elements of one table of boxes against boxes, and pairs of triangles whose axes are worked out at a time.
_BOXES_AT_ONCE, _PAIRS_AT_ONCE = 20_000_000, 100_000


def judge_surfaces(
    first: Surface,
    position: Floats,
    quaternion: Floats,
    second: Surface,
    other_position: Floats,
    other_quaternion: Floats,
) -> Judgement:
    """Whether two triangle surfaces share a point.

    Parameters
    ----------
    first, second : Surface, m, each in its own frame
    position, other_position : (3,) float array, m
    quaternion, other_quaternion : (4,) float array, w x y z
    """
    one = turned(first.vertices, quaternion)
    other = turned(second.vertices, other_quaternion) + (other_position - position)
    slack = _ROUNDING * max(float(np.abs(one).max()), float(np.abs(other).max()), float(np.abs(position).max()))
    distances, _ = cKDTree(one).query(other)
    nearest_vertices = float(distances.min())
    triangles, other_triangles = one[first.faces], other[second.faces]

    def decide(f: int, g: int) -> tuple[Certificate, float | None]:
        return _decide(
            PlacedPoints(first.vertices[first.faces[f]], position, quaternion),
            PlacedPoints(second.vertices[second.faces[g]], other_position, other_quaternion),
        )

    # what touches is found among the boxes that overlap; how far surfaces are apart needs more of them
    pairs, bounds = _bounded(triangles, other_triangles, slack)
    depth = max(0.0, -float(bounds.min(initial=0.0)))
    for place in np.argsort(bounds, kind="stable").tolist():
        if bounds[place] > slack:
            break
        f, g = pairs[place].tolist()
        found, apart = decide(f, g)
        if apart is None:
            return Judgement(True, -depth, found | {"faces": [f, g]})
    pairs, bounds = _bounded(triangles, other_triangles, nearest_vertices + slack)
    gap, proof = np.inf, Certificate()
    for place in np.argsort(bounds, kind="stable").tolist():
        if bounds[place] - slack > gap:
            break
        f, g = pairs[place].tolist()
        found, apart = decide(f, g)
        if apart is not None and apart < gap:
            gap, proof = apart, found | {"nearest faces": [f, g]}
    inside = _inside(one[0], other_triangles) or _inside(other[0], triangles)
    return Judgement(False, gap, proof, contained=inside)


def _decide(first: PlacedPoints, second: PlacedPoints) -> tuple[Certificate, float | None]:
    """The exact answer for two triangles: its proof, and how far they are apart, None if they share a point."""
    one, other, unit = world_points(first, second)
    found = meet(one, other)
    if not found.holds(one, other):
        raise ArithmeticError("a certificate does not hold")
    if isinstance(found, CommonPoint):
        return certificate.of_common_point(found, one, first.position.tolist(), unit), None
    return certificate.of_plane(found, one, other), distance_along(found, one, other, unit)


def _bounded(triangles: Floats, others: Floats, reach: float) -> tuple[Ints, Floats]:
    """Pairs of triangles whose boxes are within reach, and how far each pair is apart at the least."""
    pairs = _close_boxes(triangles, others, reach)
    parts = np.array_split(pairs, len(pairs) // _PAIRS_AT_ONCE + 1)
    return pairs, np.concatenate([_separation(triangles[some[:, 0]], others[some[:, 1]]) for some in parts])


def _close_boxes(triangles: Floats, others: Floats, reach: float) -> Ints:
    """(k, 2): triangles whose axis-aligned boxes are within reach of each other."""
    low, high = triangles.min(axis=1) - reach, triangles.max(axis=1) + reach
    other_low, other_high = others.min(axis=1), others.max(axis=1)
    near = np.flatnonzero(((low <= other_high.max(axis=0)) & (high >= other_low.min(axis=0))).all(axis=1))
    other_near = np.flatnonzero(((other_low <= high.max(axis=0)) & (other_high >= low.min(axis=0))).all(axis=1))
    found = [np.empty((0, 2), np.int64)]
    for some in np.array_split(near, len(near) * len(other_near) // _BOXES_AT_ONCE + 1):
        close = np.ones((len(some), len(other_near)), np.bool_)
        for axis in range(3):
            close &= low[some, axis][:, None] <= other_high[other_near, axis]
            close &= high[some, axis][:, None] >= other_low[other_near, axis]
        rows, columns = np.nonzero(close)
        found.append(np.column_stack([some[rows], other_near[columns]]))
    return np.concatenate(found)


def _separation(first: Floats, second: Floats) -> Floats:
    """(k,): how far pairs of triangles are apart at the least; negative, how deep they overlap at the most."""
    edges, other_edges = (np.roll(corners, -1, axis=1) - corners for corners in (first, second))
    normal, other_normal = (np.cross(e[:, 0], e[:, 1])[:, None] for e in (edges, other_edges))
    crossed = np.cross(edges[:, :, None], other_edges[:, None]).reshape(len(first), 9, 3)
    axes = np.concatenate(
        [normal, other_normal, np.cross(normal, edges), np.cross(other_normal, other_edges), crossed], axis=1
    )
    lengths = np.linalg.norm(axes, axis=2)
    # the cross product of nearly parallel edges is mostly rounding; as a direction it is as good as any
    sound = lengths > 0
    axes = axes / np.where(sound, lengths, 1.0)[:, :, None]
    along, other_along = (np.einsum("kax,kcx->kac", axes, corners) for corners in (first, second))
    gaps = np.maximum(along.min(axis=2) - other_along.max(axis=2), other_along.min(axis=2) - along.max(axis=2))
    return np.asarray(np.where(sound, gaps, -np.inf).max(axis=1), np.float64)


def _inside(point: Floats, triangles: Floats) -> bool:
    """Whether a surface winds around a point, by the solid angles of its triangles."""
    a, b, c = (triangles[:, corner] - point for corner in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    base = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return bool(abs(np.arctan2(volume, base).sum()) > np.pi)


def turned(points: Floats, quaternion: Floats) -> Floats:
    """Points turned by a quaternion w x y z."""
    w, vector = quaternion[0], quaternion[1:]
    across = 2.0 * np.cross(vector, points)
    return np.asarray(points + w * across + np.cross(vector, across), np.float64)
