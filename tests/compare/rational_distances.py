"""The judge of distances against those by features, one by one, in fractions, on random and degenerate pairs.

python -m tests.compare.rational_distances COUNT [SEED]
"""

import sys
from fractions import Fraction

import numpy as np

from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, surface_distance
from tests.compare.plain_distances import hulls, triangles

FORMS = ["", "needle", "segment", "point", "above", "coplanar", "shifted", "far", "grid", "parallel", "shared corner"]
STRAIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def exactly(distance, one, other):
    """A squared distance of points that are doubles, asked of integers: they are quicker than fractions."""
    scale = max(Fraction(part).denominator for part in (*one.flat, *other.flat))  # a power of two
    whole = [[[int(Fraction(part) * scale) for part in point] for point in points.tolist()] for points in (one, other)]
    return Fraction(distance(*whole)) / scale**2


def pair_of_triangles(rng, form):
    one, other = rng.normal(size=(2, 3, 3))
    if form == "needle":
        one[2] = one[0] + 10.0 ** -rng.integers(3, 12) * rng.normal(size=3)
    elif form == "segment":
        one[2] = (one[0] + one[1]) / 2
    elif form == "point":
        one[:] = one[0]
    elif form == "above":
        other += one.mean(axis=0) - other[0] + 1e-9 * np.cross(one[1] - one[0], one[2] - one[0])
    elif form == "coplanar":
        one[:, 2], other[:, 2] = 0, rng.choice([0, 1e-12])
    elif form == "shifted":
        other = one + 1e-6 * rng.normal(size=3)
    elif form == "far":
        other = 1e-3 * other + 1e6
    elif form == "grid":
        one, other = rng.integers(-2, 3, (2, 3, 3)).astype(float)
    elif form == "parallel":
        other[0], other[1] = one[0] + 0.5, one[1] + 0.5
    elif form == "shared corner":
        other[0] = one[0]
    return one, other


def wrong_pairs(count, seed=0):
    """(numbers of pairs on which judge and features differ, by their forms)."""
    rng, wrong = np.random.default_rng(seed), []
    face = np.arange(3)[None]
    for k in range(count):
        form = FORMS[k % len(FORMS)]
        one, other = pair_of_triangles(rng, form)
        first, second = PlacedPoints(one, np.zeros(3), STRAIGHT), PlacedPoints(other, np.zeros(3), STRAIGHT)
        found = surface_distance(first, face, second, face)
        found.check(first, face, second, face)
        if not found.lower == found.upper == exactly(triangles, one, other):
            wrong.append((k, form))
        if k % 10 == 0:
            one, other = rng.normal(size=(2, 4 + k % 3, 3)) if k % 20 else rng.integers(-2, 3, (2, 5, 3)).astype(float)
            other = other + rng.uniform(0, 4, 3).round(1)
            first, second = PlacedPoints(one, np.zeros(3), STRAIGHT), PlacedPoints(other, np.zeros(3), STRAIGHT)
            found = hull_distance(first, second)
            whole = np.arange(len(one))[None]
            found.check(first, whole, second, whole)
            if not found.lower == found.upper == exactly(hulls, one, other):
                wrong.append((k, "hull"))
    return wrong


if __name__ == "__main__":
    wrong = wrong_pairs(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(f"{len(wrong)} wrong of {sys.argv[1]}: {wrong[:10]}")
