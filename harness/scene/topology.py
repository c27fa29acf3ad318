"""What the edges of a triangle surface say about it: is it closed, convex, in one piece."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from harness.scene.hull import Hull

Index = TypeVar("Index", bound=np.integer[Any])
# How far inside its hull a vertex of a convex mesh may lie, of the mesh's diameter.
ON_HULL = 1e-9


@dataclass(frozen=True)
class Topology:
    """Counts over the edges of a surface.

    Parameters
    ----------
    edges : of all faces, each counted once
    boundary : edges of one face
    nonmanifold : edges of three and more faces, where the surface is no manifold
    turned : edges of two faces that run around it in contrary senses, so that one is inside out
    pieces : parts that share no vertex
    """

    edges: int
    boundary: int
    nonmanifold: int
    turned: int
    pieces: int

    @property
    def watertight(self) -> bool:
        """Whether every edge belongs to exactly two faces."""
        return self.boundary == 0 and self.nonmanifold == 0


def topology(faces: NDArray[np.int32], vertices: int) -> Topology:
    """Counts over the edges of faces, (f, 3) int array, each of whose vertices is used.

    Faces that name a vertex twice have no edges and are passed over.

    >>> tetrahedron = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], np.int32)
    >>> topology(tetrahedron, 4).watertight, topology(tetrahedron[1:], 4).boundary
    (True, 3)
    """
    edges, first, uses = _edges(proper(faces))
    forward = np.bincount(edges, weights=first, minlength=len(uses))
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(vertices, vertices))
    return Topology(
        edges=len(uses),
        boundary=int((uses == 1).sum()),
        nonmanifold=int((uses > 2).sum()),
        turned=int(((uses == 2) & (forward != 1)).sum()),
        pieces=int(connected_components(graph, directed=False, return_labels=False)),
    )


def is_own_hull(vertices: NDArray[np.float64], faces: NDArray[np.int32], hull: Hull) -> bool:
    """Whether a surface is its own hull.

    It is when it is closed and in one piece without handles, bends outward at no edge, has all its vertices on the
    hull and encloses the hull's volume.

    Parameters
    ----------
    vertices : (v, 3) float array, of a diameter of about 1
    faces : (f, 3) int array
    hull : Hull of the vertices
    """
    faces = proper(faces)
    about = topology(faces, len(vertices))
    if not about.watertight or about.pieces != 1 or len(vertices) - about.edges + len(faces) != 2:
        return False
    # Seen from a point inside, which way a face is turned can be told without trusting the file.
    inside = hull.vertices.mean(axis=0)
    a, b, c = (vertices[faces[:, k]] - inside for k in range(3))
    normals = np.cross(b - a, c - a)
    heights = np.einsum("ij,ij->i", normals, a)
    if abs(np.abs(heights).sum() / 6 - volume(hull.vertices, hull.faces)) > ON_HULL:
        return False
    normals *= np.where(heights < 0, -1, 1)[:, None]
    lengths = np.linalg.norm(normals, axis=1)
    normals /= np.where(lengths > 0, lengths, 1)[:, None]
    heights = np.abs(heights) / np.where(lengths > 0, lengths, 1)

    edges, _, _ = _edges(faces)
    order = np.argsort(edges, kind="stable")
    left, right = order[::2], order[1::2]  # the two half-edges of each edge
    count = len(faces)
    for one, other in ((left, right), (right, left)):
        apex = vertices[faces[other % count, (other // count + 2) % 3]] - inside
        above = np.einsum("ij,ij->i", normals[one % count], apex) - heights[one % count]
        if (above > ON_HULL).any():
            return False
    return _on_hull(vertices, hull)


def area(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """(f,) float array: the area of each face."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)


def volume(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> float:
    """Signed volume of a closed surface, positive where its faces run counter-clockwise seen from outside."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6)


def proper(faces: NDArray[Index]) -> NDArray[Index]:
    """The faces that have three different vertices."""
    distinct: NDArray[np.bool_] = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return faces[distinct]


def compact(faces: NDArray[np.integer]) -> tuple[NDArray[np.int32], NDArray[np.integer]]:
    """The faces with their vertices numbered anew, in the same order and without gaps, and the numbers they had."""
    used, renumbered = np.unique(faces, return_inverse=True)
    return renumbered.reshape(-1, 3).astype(np.int32), used


def _edges(faces: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.bool_], NDArray[np.int64]]:
    """The half-edges of faces (first those from corner 0, then from 1, then from 2).

    Returns the edge each belongs to, whether it runs from the lower to the higher vertex, and each edge's half-edges.
    """
    half = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    low, high = half.min(axis=1), half.max(axis=1)
    _, edges, uses = np.unique(low * (int(faces.max(initial=0)) + 1) + high, return_inverse=True, return_counts=True)
    return edges, half[:, 0] < half[:, 1], uses


def _on_hull(vertices: NDArray[np.float64], hull: Hull) -> bool:
    """Whether every vertex lies on the hull's surface."""
    a, b, c = (hull.vertices[hull.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    solid = lengths > 0
    normals = normals[solid] / lengths[solid, None]
    planes = np.einsum("ij,ij->i", normals, a[solid])
    corners = {row.tobytes() for row in hull.vertices}
    others = np.array([row for row in vertices if row.tobytes() not in corners]).reshape(-1, 3)
    rows = max(1, 10_000_000 // len(planes))
    return all(
        ((others[start : start + rows] @ normals.T - planes).max(axis=1) >= -ON_HULL).all()
        for start in range(0, len(others), rows)
    )
