"""The pairs of bodies whose bounding spheres touch."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from harness.arrays import Floats, Pairs


def touching_spheres(positions: Floats, radii: Floats) -> Pairs:
    """Their numbers i < j, sorted.

    Parameters
    ----------
    positions : (n, 3) float array, m
    radii : (n,) float array, m

    Returns
    -------
    (k, 2) int array
    """
    pairs = cKDTree(positions).query_pairs(2.0 * float(radii.max()), output_type="ndarray")
    apart = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
    near = np.sort(pairs[apart <= radii[pairs].sum(axis=1)], axis=1)
    return np.asarray(near[np.lexsort((near[:, 1], near[:, 0]))], np.int64)
