"""The smallest sphere around points.

It is an LP-type problem (Welzl 1991, Gärtner 1999): at most four points determine the sphere, and it can be found by
repeatedly adding the point furthest outside to the points that determine the sphere so far. The radius grows with each
step, so no set of points comes back. Cospherical points are no special case: as soon as nothing is outside, it ends.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

# A point counts as inside up to this fraction of the radius: some hundred roundings of the arithmetic below.
INSIDE = 1e-14


def bounding_sphere(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Centre and radius of the smallest sphere around points.

    Parameters
    ----------
    points : (n, 3) float array, n >= 1, finite. Vertices of the convex hull are enough.

    Returns
    -------
    centre : (3,) float array
    radius : float
        No point is further from the centre than this; it exceeds the least possible by rounding only.

    Examples
    --------
    >>> centre, radius = bounding_sphere(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.5, 0.0]]))
    >>> centre.tolist(), radius
    ([1.0, 0.0, 0.0], 1.0)
    """
    # Shifted and scaled so that neither squares nor cancellation lose digits, wherever the points are.
    low, high = points.min(axis=0), points.max(axis=0)
    shift, scale = low + (high - low) / 2, float((high - low).max()) or 1.0
    scaled = (points - shift) / scale

    support = scaled[:1]
    centre, radius = support[0], 0.0
    best = _reach(scaled, centre)
    best_centre = centre
    while True:
        distances = np.linalg.norm(scaled - centre, axis=1)
        furthest = int(distances.argmax())
        if distances[furthest] < best:
            best, best_centre = float(distances[furthest]), centre
        if distances[furthest] <= radius * (1 + INSIDE):
            break
        support, centre, grown = _sphere_of_few(support, scaled[furthest])
        if grown <= radius:  # only rounding is left
            break
        radius = grown
    centre = best_centre * scale + shift
    return centre, _reach(points, centre)


def _reach(points: NDArray[np.float64], centre: NDArray[np.float64]) -> float:
    """Distance from the centre to the furthest point."""
    return float(np.linalg.norm(points - centre, axis=1).max())


def _sphere_of_few(
    support: NDArray[np.float64], added: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Smallest sphere around up to four points and one outside their sphere, which therefore lies on the new one.

    Returns the points that determine it, its centre and its radius.
    """
    few = np.vstack([support, added])
    chosen, centre, radius, least = few[-1:], added, 0.0, np.inf
    for size in range(1, min(len(support), 3) + 1):
        for others in combinations(range(len(support)), size):
            corners = np.vstack([added, support[list(others)]])
            middle = _circumcentre(corners)
            if middle is None:
                continue
            around = float(np.linalg.norm(corners - middle, axis=1).max())
            # The least sphere around all among those through a few: the one that reaches furthest out the least.
            reach = max(around, _reach(few, middle))
            if reach < least * (1 - INSIDE):
                chosen, centre, radius, least = corners, middle, around, reach
    return chosen, centre, radius


def _circumcentre(corners: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The point nearest to all corners that is as far from each, in their own line, plane or space; None if flat."""
    edges = corners[1:] - corners[0]
    gram = edges @ edges.T
    try:
        weights = np.linalg.solve(gram, np.diag(gram) / 2)
    except np.linalg.LinAlgError:
        return None
    return np.asarray(corners[0] + weights @ edges)
