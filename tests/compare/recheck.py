"""Proves anew, by plain fractions, what is true of every pose about which the published atlas calls an engine wrong.

    python -m tests.compare.recheck [results/published/atlas/accusations.json ...]

Nothing of harness is imported. A row has both bodies as they were judged: vertices (of a mesh triangles, too), position
and quaternion, all doubles, and the certificate: weights of a common point, or a normal of a plane between hulls; of a
gap, weights of the nearest points. That two surfaces are apart, and how far, is proven triangle by triangle.
"""

import json
import sys
from fractions import Fraction
from itertools import product
from math import lcm
from pathlib import Path

from tests.compare.plain_distances import cross, dot, minus, triangles

PUBLISHED = Path(__file__).parents[2] / "results/published/atlas/accusations.json"


def world(body):
    """The vertices in the world."""
    w, x, y, z = map(Fraction, body["quaternion"])
    n = w * w + x * x + y * y + z * z
    turn = (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return [
        [sum(a * Fraction(c) for a, c in zip(row, vertex, strict=True)) / n + Fraction(t)
         for row, t in zip(turn, body["position"], strict=True)]
        for vertex in body["vertices"]
    ]  # fmt: skip


def as_integers(*sides):
    """Points in units so small that all are whole: what is asked of them asks for no unit, and integers are quicker."""
    unit = lcm(*(part.denominator for points in sides for point in points for part in point))
    return [[[int(part * unit) for part in point] for point in points] for points in sides]


def proven(row):
    """Whether the certificate of a row proves what it says of touching, or that a gap was told wrong."""
    if "query" in row:
        return is_off(row, *told_apart(row))
    proof, bodies = row["certificate"], row["bodies"]
    if row["shape"] == "sphere":
        squared = sum((Fraction(a) - Fraction(b)) ** 2 for a, b in zip(*(b["position"] for b in bodies), strict=True))
        return (squared <= (sum(Fraction(body["size"]) for body in bodies) / 2) ** 2) == row["touching"]
    one, other = as_integers(*map(world, bodies))
    if row["touching"]:
        return have_common_point(proof, bodies, one, other)
    if row["shape"] == "hull":
        return parts(list(map(Fraction, proof["normal"])), one, other)
    triangles = [[[points[k] for k in face] for face in body["faces"]]
                 for points, body in zip((one, other), bodies, strict=True)]  # fmt: skip
    return all(apart(first, second) for first, second in product(*triangles))


def is_off(row, nearer, farther):
    """Whether what was told is wrong by more than is allowed.

    Parameters
    ----------
    nearer, farther : whether the gap is proven to be less, or more, than a length
    """
    within, allowed = Fraction(row["within"]), Fraction(row["allowed"])
    if row["told"] is None:  # not reported
        return nearer(within - allowed)
    if row["query"] == "tolerance":
        return farther(within + allowed)
    told = Fraction(row["told"])
    return nearer(told - allowed) or farther(told + allowed)


def told_apart(row):
    """What decides whether the gap is proven to be less than a length, and whether to be more."""
    bodies = row["bodies"]
    if row["shape"] == "sphere":
        squared = sum((Fraction(a) - Fraction(b)) ** 2 for a, b in zip(*(b["position"] for b in bodies), strict=True))
        reach = sum(Fraction(body["size"]) for body in bodies) / 2
        return (lambda x: x > 0 and squared < (reach + x) ** 2), (lambda x: x < 0 or squared > (reach + x) ** 2)
    one, other = map(world, bodies)
    faces = [body["faces"] or [range(len(body["vertices"]))] for body in bodies]
    points = [mean(side, of, parts) for side, of, parts in zip(proof_of(row), (one, other), faces, strict=True)]
    between = minus(*points)
    upper = dot(between, between)
    if not upper:
        lower = upper
    elif row["shape"] == "hull":
        width = min(dot(between, point) for point in one) - max(dot(between, point) for point in other)
        lower = width * width / upper if width > 0 else 0
    else:
        lower = nearest_triangles(faces, one, other)
    return (lambda x: x > 0 and upper < x * x), (lambda x: x < 0 or lower > x * x)


def proof_of(row):
    return row["certificate"]["first"], row["certificate"]["second"]


def mean(side, points, parts):
    """Of some points of one part, by their weights, positive and of sum 1."""
    shares = [(k, Fraction(share)) for k, share in side]
    assert min(share for _, share in shares) > 0
    assert sum(share for _, share in shares) == 1
    assert any({k for k, _ in shares} <= set(part) for part in parts)
    return [sum(share * points[k][axis] for k, share in shares) for axis in range(3)]


def nearest_triangles(faces, one, other):
    """The squared distance of two surfaces, by all pairs of their triangles."""
    scale = lcm(*(part.denominator for point in (*one, *other) for part in point))
    whole = [[[int(part * scale) for part in point] for point in points] for points in (one, other)]
    sides = [[[points[k] for k in face] for face in of] for of, points in zip(faces, whole, strict=True)]
    return Fraction(min(triangles(first, second) for first, second in product(*sides))) / scale**2


def have_common_point(proof, bodies, one, other):
    """Whether weights, positive and of sum 1, of vertices of either body give the same point."""
    sides = proof["first"], proof["second"]
    if "faces" in proof:  # weights of the corners of two triangles
        corners = [body["faces"][face] for body, face in zip(bodies, proof["faces"], strict=True)]
        sides = [[(names[k], share) for k, share in side] for names, side in zip(corners, sides, strict=True)]
    points = []
    for vertices, side in zip((one, other), sides, strict=True):
        shares = [(k, Fraction(share)) for k, share in side]
        if min(share for _, share in shares) <= 0 or sum(share for _, share in shares) != 1:
            return False
        points.append([sum(share * vertices[k][axis] for k, share in shares) for axis in range(3)])
    return points[0] == points[1]


def parts(normal, one, other):
    """Whether a plane of this normal keeps two sets of points apart."""
    heights, others = ([dot(normal, point) for point in points] for points in (one, other))
    return min(heights) > max(others) or max(heights) < min(others)


def apart(first, second):
    """Whether two triangles are apart, by the axes among which there is one that parts them."""
    edges, other_edges = ([minus(side[k], side[k - 1]) for k in range(3)] for side in (first, second))
    normal, other_normal = cross(*edges[:2]), cross(*other_edges[:2])
    axes = [normal, other_normal, *(cross(a, b) for a, b in product(edges, other_edges))]
    axes += [cross(normal, edge) for edge in edges] + [cross(other_normal, edge) for edge in other_edges]
    return any(parts(axis, first, second) for axis in axes)


if __name__ == "__main__":
    rows = [row for path in sys.argv[1:] or [PUBLISHED] for row in json.loads(Path(path).read_text())]
    honest = [
        place for place, row in enumerate(rows) if not proven(row) or row.get("says", True) == row.get("touching")
    ]
    print(f"{len(rows) - len(honest)} of {len(rows)} accusations are proven")
    for place in honest:
        print(f"row {place}: {rows[place]['engine']}, {rows[place]['family']}: not proven")
    sys.exit(bool(honest))
