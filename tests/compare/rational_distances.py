"""Squared distances of triangles and small hulls by their features, one by one, in fractions: slow and plain.

    python -m tests.compare.rational_distances COUNT [SEED]

holds the judge of distances against them on random and degenerate pairs.
"""

import sys
from fractions import Fraction
from itertools import combinations

import numpy as np

from harness.compare.exact import Placed
from harness.compare.exact_distance import hull_distance, surface_distance

FORMS = ["", "needle", "segment", "point", "above", "coplanar", "shifted", "far", "grid", "parallel", "shared corner"]
STRAIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def point_to_segment(x, a, b):
    along, to = minus(b, a), minus(x, a)
    length = dot(along, along)
    part = min(max(Fraction(dot(to, along), length), 0), 1) if length else 0
    rest = [t - part * s for t, s in zip(to, along, strict=True)]
    return dot(rest, rest)


def segments(p, q, r, s):
    best = min(
        point_to_segment(p, r, s), point_to_segment(q, r, s), point_to_segment(r, p, q), point_to_segment(s, p, q)
    )
    u, v, w = minus(q, p), minus(s, r), minus(p, r)
    uu, uv, vv, uw, vw = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    determinant = uu * vv - uv * uv
    if determinant:
        on_first, on_second = (Fraction(part, determinant) for part in (uv * vw - vv * uw, uu * vw - uv * uw))
        if 0 <= on_first <= 1 and 0 <= on_second <= 1:
            rest = [c + on_first * a - on_second * b for a, b, c in zip(u, v, w, strict=True)]
            best = min(best, dot(rest, rest))
    return best


def over(face, normal, x):
    return all(dot(cross(minus(face[k], face[k - 1]), minus(x, face[k - 1])), normal) >= 0 for k in range(3))


def triangles(one, other):
    """The squared distance of two triangles of integers, (3, 3) lists."""
    best = min(segments(one[i - 1], one[i], other[j - 1], other[j]) for i in range(3) for j in range(3))
    for face, points in ((one, other), (other, one)):
        normal = cross(minus(face[1], face[0]), minus(face[2], face[0]))
        area = dot(normal, normal)
        if not area:
            continue
        heights = [dot(minus(x, face[0]), normal) for x in points]
        for k in range(3):
            foot = [c - Fraction(heights[k], area) * n for c, n in zip(points[k], normal, strict=True)]
            if over(face, normal, foot):
                best = min(best, Fraction(heights[k] ** 2, area))
            if heights[k - 1] * heights[k] < 0:
                part = Fraction(heights[k - 1], heights[k - 1] - heights[k])
                through = [a + part * (b - a) for a, b in zip(points[k - 1], points[k], strict=True)]
                if over(face, normal, through):
                    return Fraction(0)
    return best


def inside(points, x):
    """Whether a point is in the hull of some: in one of their tetrahedra."""
    for a, b, c, d in combinations(points, 4):
        whole = dot(cross(minus(b, a), minus(c, a)), minus(d, a))
        if whole and all(
            dot(cross(minus(q, p), minus(r, p)), minus(x, p)) * dot(cross(minus(q, p), minus(r, p)), minus(s, p)) >= 0
            for p, q, r, s in ((a, b, c, d), (a, b, d, c), (a, c, d, b), (b, c, d, a))
        ):
            return True
    return False


def hulls(one, other):
    """The squared distance of the hulls of a few points."""
    if inside(one, other[0]) or inside(other, one[0]):
        return Fraction(0)
    return min(triangles(p, q) for p in sides(one) for q in sides(other))


def sides(points):
    """Of all triangles of some points those with none of the points on one side: hulls apart are nearest there."""
    for a, b, c in combinations(points, 3):
        normal = cross(minus(b, a), minus(c, a))
        heights = [dot(minus(x, a), normal) for x in points]
        if min(heights) >= 0 or max(heights) <= 0:
            yield a, b, c


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
        first, second = Placed(one, np.zeros(3), STRAIGHT), Placed(other, np.zeros(3), STRAIGHT)
        found = surface_distance(first, face, second, face)
        found.check(first, face, second, face)
        if not found.lower == found.upper == exactly(triangles, one, other):
            wrong.append((k, form))
        if k % 10 == 0:
            one, other = rng.normal(size=(2, 4 + k % 3, 3)) if k % 20 else rng.integers(-2, 3, (2, 5, 3)).astype(float)
            other = other + rng.uniform(0, 4, 3).round(1)
            first, second = Placed(one, np.zeros(3), STRAIGHT), Placed(other, np.zeros(3), STRAIGHT)
            found = hull_distance(first, second)
            whole = np.arange(len(one))[None]
            found.check(first, whole, second, whole)
            if not found.lower == found.upper == exactly(hulls, one, other):
                wrong.append((k, "hull"))
    return wrong


if __name__ == "__main__":
    wrong = wrong_pairs(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(f"{len(wrong)} wrong of {sys.argv[1]}: {wrong[:10]}")
