"""Vertices that lie within rounding of another made one with it, so that faces meet where a program left cracks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.topology import proper

# Others within the distance of a vertex, in the mean; more means that the distance is not one of rounding.
MOST_NEIGHBOURS = 100


def weld(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], within: float
) -> tuple[NDArray[np.float64], NDArray[np.int32], int]:
    """A mesh in which no two vertices are within a distance of each other.

    Each vertex, in order, takes up those after it that are within the distance and not taken up yet; so none moves
    further than the distance, however long a chain of near vertices is.

    Parameters
    ----------
    vertices : (v, 3) float array
    faces : (f, 3) int array
    within : distance, in the unit of the vertices

    Returns
    -------
    vertices : (w, 3) float array, some of the vertices, in their order
    faces : (g, 3) int32 array, those whose three corners are still different
    welded : how many vertices became one with another

    Raises
    ------
    InputError
        If the distance is not positive, or so large that most vertices or all faces are within it.
    """
    from scipy.spatial import cKDTree

    if not 0 < within < np.inf:
        raise InputError(f"vertices are welded within a positive distance, not {within:g}")
    tree = cKDTree(vertices)
    if tree.count_neighbors(tree, within) > (MOST_NEIGHBOURS + 1) * len(vertices):
        raise InputError(
            f"within {within:g} of each vertex are more than {MOST_NEIGHBOURS} others: that is no distance of rounding"
        )
    pairs = tree.query_pairs(within, output_type="ndarray")
    firsts, seconds = pairs[np.lexsort(pairs.T[::-1])].T
    owners, starts = np.unique(firsts, return_index=True)
    target = np.arange(len(vertices))
    for owner, start, end in zip(owners, starts, np.append(starts, len(firsts))[1:], strict=True):
        if target[owner] == owner:
            near = seconds[start:end]
            target[near[target[near] == near]] = owner
    kept, renumbered = np.unique(target, return_inverse=True)
    faces = proper(renumbered.reshape(-1)[faces].astype(np.int32))
    if not len(faces):
        raise InputError(f"within {within:g} of each other are two corners of every face: nothing would be left")
    return vertices[kept], faces, len(vertices) - len(kept)
