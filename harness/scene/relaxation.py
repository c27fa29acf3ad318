"""Dense packings of any sizes: spheres start anywhere and push each other apart until none overlap.

The sum of all squared overlaps is minimised within the box (O'Hern et al. 2003, with hard walls); where it falls to
zero the spheres are placed. That works up to about the density at which spheres jam, .6 and more.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

STEPS = 1000
# Spheres are pushed this much further apart, of their radii, than they must be: overlaps end before the very minimum.
MARGIN = 1e-4


def relaxed(radii: NDArray[np.float64], half: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Centres of spheres inside a box, pushed apart.

    Parameters
    ----------
    radii : (n,) float array, m
    half : (3,) float array, m, half the sides of the box
    rng : the source of all randomness

    Returns
    -------
    (n, 3) float array, m
        The spheres are inside the box. Some may still overlap: ask `overlapping`.
    """
    from scipy.optimize import minimize  # a fifth of a second, which most scenes need not spend

    unit = float(radii.mean())
    inner = np.maximum(half - radii[:, None], 0) / unit
    start = (2 * rng.random(inner.shape) - 1) * inner
    found = minimize(
        _overlap,
        start.ravel(),
        args=(radii / unit * (1 + MARGIN),),
        jac=True,
        method="L-BFGS-B",
        bounds=np.column_stack([-inner.ravel(), inner.ravel()]),
        options={"maxiter": STEPS, "maxfun": 2 * STEPS, "ftol": 0.0, "gtol": 1e-12},
    )
    return np.asarray(found.x.reshape(-1, 3) * unit)


def overlapping(positions: NDArray[np.float64], radii: NDArray[np.float64]) -> NDArray[np.int64]:
    """(k, 2) int array: the pairs of spheres that overlap, each once, in no order.

    Spheres are sorted into classes of radii within a factor of 2, so that a few large ones do not make all pairs close.
    """
    from scipy.spatial import cKDTree

    if len(radii) == 0:
        return np.empty((0, 2), np.int64)
    classes = np.floor(np.log2(radii.max() / radii)).astype(int)
    members = [np.flatnonzero(classes == kind) for kind in np.unique(classes)]
    trees = [cKDTree(positions[member]) for member in members]
    pairs = [np.empty((0, 2), np.int64)]
    for a, one in enumerate(members):
        for b, two in enumerate(members[: a + 1]):
            reach = radii[one].max() + radii[two].max()
            near = trees[a].sparse_distance_matrix(trees[b], reach, output_type="ndarray")
            i, j = one[near["i"]], two[near["j"]]
            overlap = (near["v"] < radii[i] + radii[j]) & ((a != b) | (i < j))
            pairs.append(np.column_stack([i[overlap], j[overlap]]))
    return np.concatenate(pairs)


def _overlap(flat: NDArray[np.float64], radii: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """The sum of all squared overlaps, and its gradient."""
    positions = flat.reshape(-1, 3)
    i, j = overlapping(positions, radii).T
    apart = positions[i] - positions[j]
    distances = np.linalg.norm(apart, axis=1)
    depth = radii[i] + radii[j] - distances
    push = -2 * (depth / np.where(distances > 0, distances, 1))[:, None] * apart
    gradient = np.empty_like(positions)
    for axis in range(3):
        gradient[:, axis] = np.bincount(i, push[:, axis], len(radii)) - np.bincount(j, push[:, axis], len(radii))
    return float(depth @ depth), gradient.ravel()
