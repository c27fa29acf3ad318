"""Squared distances of triangles and small hulls by their features, one by one, in fractions: slow and plain.

Nothing of harness is imported.
"""

from fractions import Fraction
from itertools import combinations


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
