"""A surface cut into parts for proofs: a tree down to single triangles, each node enclosed in a ball and in a slab.

Plain numpy, and no more than what a proof needs: that all triangles below a node lie within its ball and its slab. A
sphere is one part, a triangle of no extent with a radius around it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats, Ints
from harness.scene.mesh import Triangles

# Relative surplus of balls and slabs: thousands of times what the roundings of a float take from them.
SURPLUS = 1e-12


class Parts(NamedTuple):
    """The trees of several surfaces behind one another; a coordinate is a row of an array.

    Attributes
    ----------
    roots : (m,) int array, the first node of each surface
    centres : (3, n) float array, of the balls
    radii : (n,) float array
    normals : (3, n) float array, across the slabs, whose middle planes go through the centres
    halves : (n,) float array, half the thickness of the slabs
    left, right : (n,) int array, children; -1 of a leaf
    leaves : (n,) int array, the triangle of a leaf; -1 of another node
    corners : (3, 3, f) float array, of coordinate, corner and triangle
    faces : (f,) int array, which face of its own surface a triangle is
    around : (f,) float array, the radius around a triangle, 0 of a surface
    """

    roots: Ints
    centres: Floats
    radii: Floats
    normals: Floats
    halves: Floats
    left: Ints
    right: Ints
    leaves: Ints
    corners: Floats
    faces: Ints
    around: Floats


def surface_parts(vertices: Floats, faces: Triangles) -> Parts:
    """The tree of one surface; vertices (v, 3) in any unit."""
    triangles = np.ascontiguousarray(vertices[faces], np.float64)
    order: list[tuple[Ints, int]] = [(np.arange(len(faces)), -1)]
    nodes = 2 * len(faces) - 1
    centres, radii, normals, halves = np.empty((3, nodes)), np.empty(nodes), np.empty((3, nodes)), np.empty(nodes)
    left, right, leaves = (np.full(nodes, -1, np.int64) for _ in range(3))
    centroids = triangles.mean(axis=1)
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    node = 0
    while order:
        some, parent = order.pop()
        if parent >= 0:
            (left if left[parent] < 0 else right)[parent] = node
        found = _enclosed(triangles[some].reshape(-1, 3), crossed[some].sum(axis=0))
        centres[:, node], radii[node], normals[:, node], halves[node] = found
        if len(some) == 1:
            leaves[node] = some[0]
        else:
            spread = centroids[some]
            along = spread[:, np.ptp(spread, axis=0).argmax()]
            sorted_along = some[np.argsort(along, kind="stable")]
            order.append((sorted_along[len(some) // 2 :], node))
            order.append((sorted_along[: len(some) // 2], node))
        node += 1
    return Parts(
        roots=np.zeros(1, np.int64),
        centres=centres,
        radii=radii,
        normals=normals,
        halves=halves,
        left=left,
        right=right,
        leaves=leaves,
        corners=np.ascontiguousarray(triangles.transpose(2, 1, 0)),
        faces=np.arange(len(faces)),
        around=np.zeros(len(faces)),
    )


def sphere_parts() -> Parts:
    """A sphere of diameter 1 about the origin."""
    none = np.full(1, -1, np.int64)
    reach = np.full(1, 0.5 * (1.0 + SURPLUS))
    centre, normal = np.zeros((3, 1)), np.array([[0.0], [0.0], [1.0]])
    first = np.zeros(1, np.int64)
    return Parts(
        roots=first,
        centres=centre,
        radii=reach,
        normals=normal,
        halves=reach,
        left=none,
        right=none,
        leaves=first,
        corners=np.zeros((3, 3, 1)),
        faces=first.copy(),
        around=np.full(1, 0.5),
    )


def together(surfaces: Sequence[Parts]) -> Parts:
    """Several surfaces as one set of parts, in their order."""
    nodes = np.cumsum([0, *(len(parts.radii) for parts in surfaces)])
    triangles = np.cumsum([0, *(len(parts.faces) for parts in surfaces)])

    def shifted(name: str, by: NDArray[np.int64]) -> Ints:
        columns = [getattr(parts, name) for parts in surfaces]
        return np.concatenate([np.where(c >= 0, c + by[k], -1) for k, c in enumerate(columns)])

    def joined(name: str) -> Floats:
        return np.ascontiguousarray(np.concatenate([getattr(parts, name) for parts in surfaces], axis=-1))

    return Parts(
        roots=shifted("roots", nodes),
        centres=joined("centres"),
        radii=joined("radii"),
        normals=joined("normals"),
        halves=joined("halves"),
        left=shifted("left", nodes),
        right=shifted("right", nodes),
        leaves=shifted("leaves", triangles),
        corners=joined("corners"),
        faces=np.concatenate([parts.faces for parts in surfaces]),
        around=joined("around"),
    )


def _enclosed(points: Floats, normal: Floats) -> tuple[Floats, float, Floats, float]:
    """Centre, radius, normal and half thickness of a ball and a slab around points."""
    length = float(np.linalg.norm(normal))
    normal = normal / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
    heights = (points - centre) @ normal
    centre = centre + normal * (heights.min() + heights.max()) / 2.0
    apart = points - centre
    surplus = SURPLUS * float(np.abs(points).max())
    radius = float(np.sqrt((apart * apart).sum(axis=1).max())) * (1.0 + SURPLUS) + surplus
    half = float(np.abs(apart @ normal).max()) * (1.0 + SURPLUS) + surplus
    return centre, radius, normal, half
