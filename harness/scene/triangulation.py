"""Polygons cut into triangles: each by ear clipping in its own plane, so that a concave one keeps its notches.

The ears are clipped by manifold3d, which keeps every corner, those in the middle of a straight side too: neighbours
share all edges as before. Quadrilaterals have two ways to be cut, of which one is chosen here, for all of them at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from manifold3d import triangulate
from numpy.typing import NDArray

from harness.scene.polygon_mesh import PolygonMesh, scaled

# A corner is out of its polygon's plane from this distance on, of the mesh's extent: six digits, as text often has.
OUT_OF_PLANE = 1e-5
# A triangle turned contrary to its polygon is due to rounding if it is smaller, of the polygon's area.
TURNED = 1e-9
# Polygons of one length that are looked at together, in corners.
BLOCK = 1_000_000


class Triangulation(NamedTuple):
    """What became of polygons.

    Parameters
    ----------
    faces : (f, 3) int array, in the order of the polygons, turned as they are
    degenerate : polygons with fewer than three different corners, which were left out
    bent : polygons that are not plane
    height : how far a corner is from the plane of its polygon at most, of the mesh's extent
    crossing : polygons that cross themselves
    """

    faces: NDArray[np.int64]
    degenerate: int
    bent: int
    height: float
    crossing: int


def triangulated(mesh: PolygonMesh) -> Triangulation:
    """Cut the polygons of a mesh, whose corners must be among its vertices, into triangles.

    Parameters
    ----------
    mesh : no two vertices are equal, all are finite
    """
    if (mesh.lengths == 3).all():
        return Triangulation(mesh.corners.reshape(-1, 3), 0, 0, 0.0, 0)
    corners, lengths = _distinct(mesh.corners, mesh.lengths)
    starts = np.cumsum(lengths) - lengths
    rows = np.cumsum(np.maximum(lengths - 2, 0))  # where the triangles of the next polygon begin
    faces = np.full((int(rows[-1]) if len(rows) else 0, 3), -1)
    rows = rows - np.maximum(lengths - 2, 0)
    vertices = scaled(mesh.vertices)
    extent = float(np.ptp(vertices, axis=0).max())
    bent, highest, crossing = 0, 0.0, 0
    for length in np.unique(lengths[lengths >= 3]):
        alike = np.flatnonzero(lengths == length)
        for block in np.array_split(alike, -(-len(alike) * length // BLOCK)):
            polygons = corners[starts[block, None] + np.arange(length)]
            places = rows[block, None] + np.arange(length - 2)
            if length == 3:
                faces[places[:, 0]] = polygons
                continue
            flat, height = _flattened(vertices[polygons])
            cut, crossed = _quadrilaterals(flat) if length == 4 else _ears(flat)
            bent += int((height > OUT_OF_PLANE * extent).sum())
            highest = max(highest, float(height.max()) / extent)
            crossing += int(crossed.sum())
            faces[places] = np.where(cut < 0, -1, polygons[np.arange(len(block))[:, None, None], cut])
    return Triangulation(faces[faces[:, 0] >= 0], int((lengths < 3).sum()), bent, highest, crossing)


def _distinct(corners: NDArray[np.int64], lengths: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The polygons without corners that repeat the one before."""
    previous = np.arange(len(corners)) - 1
    ends = np.cumsum(lengths)
    previous[(ends - lengths)[lengths > 0]] = ends[lengths > 0] - 1
    kept = corners != corners[previous]
    owners = np.repeat(np.arange(len(lengths)), lengths)
    return corners[kept], np.bincount(owners[kept], minlength=len(lengths))


def _flattened(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Polygons of one length, (m, n, 3) float array, each seen along the axis that is nearest to its normal.

    No coordinate is computed, so that what is straight stays straight.

    Returns
    -------
    flat : (m, n, 2) float array; polygons run counter-clockwise
    height : (m,) float array, how far a corner is from its polygon's plane at most
    """
    arms = points[:, 1:] - points[:, :1]
    crosses = np.cross(arms[:, :-1], arms[:, 1:])
    normals = crosses.sum(axis=1)
    sizes = np.linalg.norm(crosses, axis=2)
    none = np.linalg.norm(normals, axis=1) <= TURNED * sizes.sum(axis=1)  # as much of it to the left as to the right
    normals[none] = crosses[none, sizes[none].argmax(axis=1)]
    rows = np.arange(len(points))
    axis = np.abs(normals).argmax(axis=1)
    turned = normals[rows, axis] < 0
    first, second = (axis + 1 + turned) % 3, (axis + 2 - turned) % 3
    flat = np.stack([points[rows, :, first], points[rows, :, second]], axis=2)
    lengths = np.linalg.norm(normals, axis=1)
    normals /= np.where(lengths > 0, lengths, 1)[:, None]
    heights = np.einsum("mnk,mk->mn", points - points.mean(axis=1, keepdims=True), normals)
    return flat, np.abs(heights).max(axis=1)


def _quadrilaterals(flat: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Two triangles of each of (m, 4, 2) polygons, (m, 2, 3) int array, and which polygons cross themselves.

    The diagonal from the first corner serves unless a triangle beside it would be turned or without area.
    """
    before, after = flat - np.roll(flat, 1, axis=1), np.roll(flat, -1, axis=1) - flat
    turns = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    limit = TURNED * np.abs(turns).sum(axis=1)
    first, second = turns[:, 1::2].min(axis=1), turns[:, ::2].min(axis=1)
    other = (first <= limit) & (second > first)
    cuts = np.array([[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]])
    return cuts[other.astype(int)], np.where(other, second, first) < -limit


def _ears(flat: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """n - 2 triangles of each of (m, n, 2) polygons, (m, n - 2, 3) int array, and which polygons cross themselves."""
    count, length, _ = flat.shape
    cuts = np.full((count, length - 2, 3), -1)
    for cut, polygon in zip(cuts, flat, strict=True):
        ears = triangulate([polygon])
        cut[: len(ears)] = ears
    a, b, c = (flat[np.arange(count)[:, None], cuts[..., corner]] for corner in range(3))
    areas = (b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0]
    return cuts, (areas.min(axis=1) < -TURNED * np.abs(areas).sum(axis=1)) | (cuts[:, -1, 0] < 0)
