"""Convex hull of a mesh, fit for support functions and for FCL's Convex: closed, outward, only its own vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError


@dataclass(frozen=True, eq=False)
class Hull:
    """A closed convex triangle surface; arrays are C-contiguous and read-only.

    Parameters
    ----------
    vertices : (h, 3) float array, in the units of the mesh
    faces : (g, 3) int32 array, counter-clockwise seen from outside; neighbours may be coplanar
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]


def convex_hull(points: NDArray[np.float64]) -> Hull:
    """The convex hull of points of any extent in three dimensions.

    Parameters
    ----------
    points : (n, 3) float array

    Returns
    -------
    Hull
        Its vertices are among the points, in their order.

    Raises
    ------
    InputError
        If the points are too few or too flat to enclose a volume.

    Examples
    --------
    Of the corners of a cube and its centre, the centre is no vertex of the hull:

    >>> corners = [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
    >>> hull = convex_hull(np.array([*corners, [0.0, 0.0, 0.0]]))
    >>> len(hull.vertices), len(hull.faces)
    (8, 12)
    """
    from scipy.spatial import ConvexHull, QhullError  # half a second, which a run whose mesh is at hand need not spend

    # Qt: facets with more than three corners come as triangles. Where that leaves a seam (it can where many
    # points are collinear), QJ moves the points by some 1e-11 of the extent for the search alone.
    for options in ("Qt", "QJ"):
        try:
            found = ConvexHull(points, qhull_options=options)
        except (QhullError, ValueError) as error:
            raise InputError("the mesh is flat: it has no extent in one direction, so no hull encloses it") from error
        faces = _outward(points, found.simplices, found.equations[:, :3])
        if _closed(faces):
            break
    else:
        raise InputError("no closed convex hull of the mesh was found")
    used, renumbered = np.unique(faces, return_inverse=True)
    return hull_of(points[used], renumbered.reshape(-1, 3).astype(np.int32))


def flat_hull(points: NDArray[np.float64]) -> Hull:
    """The convex hull of points in one plane: a polygon with two sides, closed, of no volume.

    Parameters
    ----------
    points : (n, 3) float array, not all on a line; how far they are from their plane is passed over

    Returns
    -------
    Hull
        Its vertices are among the points, in their order; half of its faces are turned either way.

    Examples
    --------
    >>> hull = flat_hull(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]]))
    >>> len(hull.vertices), len(hull.faces)
    (4, 4)
    """
    from scipy.spatial import ConvexHull, QhullError

    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    try:
        ring = ConvexHull((points - points.mean(axis=0)) @ axes[:2].T).vertices
    except (QhullError, ValueError) as error:
        raise InputError("the mesh has no extent in two directions: it is a line") from error
    used, ring = np.unique(ring, return_inverse=True)
    fan = np.stack([np.full(len(ring) - 2, ring[0]), ring[1:-1], ring[2:]], axis=1)
    return hull_of(points[used], np.concatenate([fan, fan[:, ::-1]]).astype(np.int32))


def hull_of(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Hull:
    """The hull with these arrays, which are copied and made read-only."""
    vertices, faces = np.array(vertices, np.float64, order="C"), np.array(faces, np.int32, order="C")
    vertices.setflags(write=False)
    faces.setflags(write=False)
    return Hull(vertices, faces)


def is_closed_and_convex(hull: Hull, within: float) -> bool:
    """Whether faces close a surface of which no vertex is farther outside than a distance: a hull of these vertices.

    Parameters
    ----------
    hull : of finite vertices or not, and of faces that may be anything
    within : in the units of the hull; what its faces and vertices may be off by rounding

    >>> cube = convex_hull(np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)]))
    >>> is_closed_and_convex(cube, 1e-9), is_closed_and_convex(hull_of(cube.vertices, cube.faces[:, ::-1]), 1e-9)
    (True, False)
    """
    vertices, faces = hull.vertices, hull.faces
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
        return False
    if not np.isfinite(vertices).all() or faces.min() < 0 or faces.max() >= len(vertices) or not _closed(faces):
        return False
    return outside(vertices, hull) <= within


def outside(points: NDArray[np.float64], hull: Hull) -> float:
    """How far the farthest of some points lies outside of a convex hull, along the normal of a face.

    Negative where all lie inside; -inf of a hull whose faces have no area.
    """
    a, b, c = (hull.vertices[hull.faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    # the normal of a sliver is mostly rounding
    proper = areas > 1e-9 * float(areas.max())
    normals = normals[proper] / areas[proper, None]
    # not by BLAS, whose threads wait longer than this takes
    heights = np.einsum("ij,kj->ik", points, normals) - np.einsum("ij,ij->i", normals, a[proper])
    return float(heights.max(initial=-np.inf))


def _outward(
    points: NDArray[np.float64], simplices: NDArray[np.int32], normals: NDArray[np.float64]
) -> NDArray[np.int32]:
    """The simplices, turned so that their corners run counter-clockwise about the outward normals."""
    a, b, c = points[simplices[:, 0]], points[simplices[:, 1]], points[simplices[:, 2]]
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals) < 0
    return np.where(inward[:, None], simplices[:, ::-1], simplices)


def _closed(faces: NDArray[np.int32]) -> bool:
    """Whether every directed edge occurs once, and its opposite too, on a surface without handles."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    here, there = np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0)
    vertices = len(np.unique(faces))
    return len(here) == len(edges) and np.array_equal(here, there) and vertices - len(edges) // 2 + len(faces) == 2
