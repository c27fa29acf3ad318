"""Which spheres touch, for libraries that cannot be asked for it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from harness.arrays import Floats, Pairs


def close_pairs(centres: Floats, radii: Floats) -> Pairs:
    """Pairs of spheres that touch, by scipy's tree.

    Parameters
    ----------
    centres : (n, 3) float array, m
    radii : (n,) float array, m
    """
    pairs = cKDTree(centres).query_pairs(2.0 * radii.max(initial=0.0), output_type="ndarray").astype(np.int64)
    between = np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    pairs = np.sort(pairs[between <= radii[pairs].sum(axis=1)], axis=1)
    ordered: Pairs = pairs[np.lexsort(pairs.T[::-1])]
    return ordered
