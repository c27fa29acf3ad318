"""A mesh of fewer faces and nearly the same shape: quadric edge collapse (Garland and Heckbert 1997)."""

from __future__ import annotations

from itertools import product

import fast_simplification
import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.bounding_sphere import bounding_sphere
from harness.scene.topology import Topology, compact, topology

# Aggressiveness, and the largest factor by which one pass lowers the number of faces. Collapses can pinch a surface,
# so that an edge gets more than two faces; another order of collapses then does not.
EFFORTS = ((7.0, np.inf), (7.0, 2.0), (6.0, 2.0), (8.0, 2.0))


def simplify(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], count: int
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """A mesh simplified to exactly so many faces, and of the same extent.

    A collapse takes two faces from a closed surface: from one with an even number of faces, an odd number is
    reached by one collapse less and leaving out one face, which opens it.

    Parameters
    ----------
    vertices : (v, 3) float array
    faces : (f, 3) int array
    count : faces wanted, at least 4

    Returns
    -------
    vertices : (w, 3) float array; minimal bounding sphere of diameter 1 about the origin
    faces : (count, 3) int32 array

    Raises
    ------
    InputError
        If there are fewer faces already, or the simplification stalls before it has so few.
    """
    if count < 4:
        raise InputError(f"a mesh cannot be simplified to {count} faces; a tetrahedron has 4")
    if count > len(faces):
        raise InputError(f"a mesh of {len(faces)} faces cannot be simplified to {count}")
    before = _topology(faces)
    pinched = None
    for aim, effort in product((count, count + 1), EFFORTS):
        if before.watertight and aim % 2:
            continue
        found, triangles = _collapsed(vertices, faces, aim, *effort)
        reached = len(triangles)
        after = _topology(triangles)
        if reached == count + 1:
            found, triangles = drop_face(found, triangles)
        if len(triangles) == count:
            if after.nonmanifold <= before.nonmanifold and (after.watertight or not before.watertight):
                return normalised(found), triangles
            pinched = pinched or (found, triangles)
    if pinched is None:
        raise InputError(f"the mesh cannot be simplified to {count} faces: it stalls at {reached}")
    return normalised(pinched[0]), pinched[1]


def normalised(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vertices with their minimal bounding sphere of diameter 1 about the origin."""
    centre, radius = bounding_sphere(vertices)
    return (vertices - centre) / (2 * radius)


def drop_face(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The mesh without the face whose corners are furthest inside the bounding sphere, where the hole matters least."""
    centre, _ = bounding_sphere(vertices)
    depth = np.linalg.norm(vertices - centre, axis=1)[faces].max(axis=1)
    return _without_unused(vertices, np.delete(faces, depth.argmin(), axis=0))


def _collapsed(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], count: int, aggressiveness: float, factor: float
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The mesh after collapses down to about so many faces."""
    while len(faces) > count:
        before = len(faces)
        target = max(count, 2 * int(before / factor / 2))
        points, triangles = fast_simplification.simplify(
            np.array(vertices, np.float64, order="C"),  # copies: it takes no read-only arrays
            np.array(faces, np.int32, order="C"),
            target_count=target,
            agg=aggressiveness,
        )
        vertices, faces = np.asarray(points, np.float64), triangles.astype(np.int32)
        if target == count or len(faces) == before:
            break
    return _without_unused(vertices, faces)


def _topology(faces: NDArray[np.int32]) -> Topology:
    """Counts over the edges of faces, of whose vertices some may be unused."""
    faces, used = compact(faces)
    return topology(faces, len(used))


def _without_unused(
    vertices: NDArray[np.float64], faces: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    faces, used = compact(faces)
    return vertices[used], faces
