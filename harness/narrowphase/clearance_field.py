"""How far points are from a closed surface, and on which side of it, to be looked up: a regular grid of distances.

A point that is nearer to a node of the grid than the surface is lies on the same side as the node, and by the
difference at least away from the surface. That is known without looking at a triangle.

A surface with a few holes, such as a pumpkin that lacks a triangle, is closed by caps; whoever asks must see to it
that nothing passes through those.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.kernel import kernel
from harness.narrowphase.containment import winding
from harness.narrowphase.triangle_tree import TriangleTree, centre_of, radius_of, triangle_tree
from harness.narrowphase.vectors import Vector, cross, dot, minus
from harness.scene.mesh import Mesh, Triangles

# Nodes along a side. With 48 a contact takes 5 % fewer steps, and making the field two and a half times as long.
NODES = 32
# Points of a surface that are looked up in the field of another. With half of them a contact takes 9 % more steps.
MOST_POINTS = 512
MOST_HOLES = 4
# Of the diameter: by how much distances are shortened, more than single precision and rounding take from them.
ROUNDING = 1e-6
# From the middle of the field to its sides, a little more than the radius of the bodies.
HALF = 0.5 + 1e-6


class ClearanceField(NamedTuple):
    """The field of a surface of diameter 1, and points of the surface.

    Attributes
    ----------
    values : (n, n, n) float32 array, of each node of a cube around the centre the distance from the surface, positive
        inside of it, 0 where the side is not known; n = 0 where the surface cannot be closed or is not in one piece, so
        that nothing is proved by it
    points : (3 k,) float array, vertices: x of all, then y, then z
    caps : (h, 4) float array, centre and radius of a sphere around each cap
    """

    values: NDArray[np.float32]
    points: Floats
    caps: Floats


def no_field() -> ClearanceField:
    """Of a surface of which nothing is to be looked up."""
    return ClearanceField(np.empty((0, 0, 0), np.float32), np.empty(0), np.empty((0, 4)))


@lru_cache(maxsize=8)  # a run loads its pipeline twice
def clearance_field(mesh: Mesh, nodes: int = NODES) -> ClearanceField:
    """The field of a mesh of diameter 1."""
    from scipy.ndimage import label  # with what follows: only a run that follows contacts of surfaces needs scipy

    from harness.scene.topology import proper, topology

    counts = topology(mesh.faces, len(mesh.vertices))
    if counts.nonmanifold or counts.turned or counts.pieces != 1:
        return no_field()
    holes = _holes(proper(mesh.faces))
    if holes is None or len(holes) > MOST_HOLES:
        return no_field()
    closing = [(hole[0], b, a) for hole in holes for a, b in pairwise(hole[1:])]
    faces = np.vstack([proper(mesh.faces), np.array(closing, np.int32).reshape(-1, 3)]).astype(np.int32)
    if topology(faces, len(mesh.vertices)).boundary:
        return no_field()
    distances = np.empty((nodes, nodes, nodes))
    measure(triangle_tree(mesh.vertices, faces), distances)
    # between neighbours that are more than half their distance from the surface there is none of it
    sides, count = label(distances > 0.5 * (2.0 * HALF / (nodes - 1)) * (1.0 + 1e-9))
    values = np.zeros(distances.shape, np.float32)
    corners = mesh.vertices[faces]
    for side in range(1, count + 1):
        there = sides == side
        at = np.unravel_index(np.argmax(np.where(there, distances, 0.0)), distances.shape)
        x, y, z = (-HALF + 2.0 * HALF / (nodes - 1) * np.array(at)).tolist()
        inside = abs(round(winding((x, y, z), corners))) % 2 == 1
        values[there] = np.maximum(distances[there] - ROUNDING, 0.0) * (1.0 if inside else -1.0)
    caps = np.array([_sphere(mesh.vertices[hole]) for hole in holes]).reshape(-1, 4)
    return ClearanceField(values, _spread(mesh.vertices), caps)


@kernel
def measure(tree: TriangleTree, distances: Floats) -> None:
    """The distance of each node from the triangles of a tree, written."""
    n = len(distances)
    pitch, known = 2.0 * HALF / (n - 1), np.inf
    for i in range(n):
        for j in range(n):
            for m in range(n):
                # there and back, so that each node is next to the last
                row = j if i % 2 == 0 else n - 1 - j
                k = m if (i * n + j) % 2 == 0 else n - 1 - m
                point = -HALF + i * pitch, -HALF + row * pitch, -HALF + k * pitch
                known = distance_from(tree, point, known + pitch * (1.0 + 1e-9))
                distances[i, row, k] = known


@kernel
def distance_from(tree: TriangleTree, point: Vector, limit: float) -> float:
    """The distance of a point from the nearest triangle of a tree, which is within a limit."""
    stack = np.empty(128, np.int64)
    stack[0] = 0
    height, best = 1, limit
    while height > 0:
        height -= 1
        node = stack[height]
        if clear_of_disc(tree, node, point) >= best:
            continue
        right = tree.right[node]
        if right < 0:
            best = min(best, distance_from_triangle(tree, -1 - right, point))
            continue
        left_first = clear_of_disc(tree, node + 1, point) < clear_of_disc(tree, right, point)
        stack[height] = right if left_first else node + 1
        stack[height + 1] = node + 1 if left_first else right
        height += 2
    return best


@kernel
def clear_of_disc(tree: TriangleTree, node: int, point: Vector) -> float:
    """How far a point is from the sphere around a node, at least."""
    x, y, z = minus(point, centre_of(tree, node))
    return float(sqrt(x * x + y * y + z * z) - radius_of(tree, node))


@kernel
def distance_from_triangle(tree: TriangleTree, k: int, point: Vector) -> float:
    """The distance of a point from a triangle."""
    c = tree.corners
    a, b = (c[k, 0, 0], c[k, 0, 1], c[k, 0, 2]), (c[k, 1, 0], c[k, 1, 1], c[k, 1, 2])
    third = c[k, 2, 0], c[k, 2, 1], c[k, 2, 2]
    normal = cross(minus(b, a), minus(third, a))
    area = dot(normal, normal)
    squared, inside = np.inf, area > 0.0
    for side in range(3):
        begin = a if side == 0 else (b if side == 1 else third)
        end = b if side == 0 else (third if side == 1 else a)
        along, arm = minus(end, begin), minus(point, begin)
        length = dot(along, along)
        part = min(1.0, max(0.0, dot(arm, along) / length)) if length > 0.0 else 0.0
        off = arm[0] - part * along[0], arm[1] - part * along[1], arm[2] - part * along[2]
        squared = min(squared, dot(off, off))
        inside = inside and dot(cross(along, arm), normal) >= 0.0
    if inside:
        height = dot(normal, minus(point, a))
        squared = min(squared, height * height / area)
    return sqrt(squared)


def _spread(vertices: Floats) -> Floats:
    """Vertices that are far from each other: each is the farthest from all before it."""
    chosen = [int(np.argmax(np.square(vertices).sum(axis=1)))]
    squared = np.full(len(vertices), np.inf)
    while len(chosen) < min(MOST_POINTS, len(vertices)):
        squared = np.minimum(squared, np.square(vertices - vertices[chosen[-1]]).sum(axis=1))
        chosen.append(int(np.argmax(squared)))
    return np.ascontiguousarray(vertices[chosen].T).ravel()


def _holes(faces: Triangles) -> list[list[int]] | None:
    """The vertices around each hole, in the sense of its faces; None if holes share a vertex."""
    sides = {(i, j) for face in faces.tolist() for i, j in zip(face, face[1:] + face[:1], strict=True)}
    open_sides = [(i, j) for i, j in sides if (j, i) not in sides]
    following = dict(sorted(open_sides))
    if len(following) != len(open_sides):
        return None
    holes = []
    while following:
        start, vertex = following.popitem()
        hole = [start]
        while vertex != start:
            hole.append(vertex)
            vertex = following.pop(vertex)
        holes.append(hole)
    return holes


def _sphere(points: Floats) -> list[float]:
    """Centre and radius of a sphere around points (k, 3)."""
    centre = points.mean(axis=0)
    return [*centre.tolist(), float(np.linalg.norm(points - centre, axis=1).max()) + ROUNDING]
