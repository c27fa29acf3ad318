"""A proof that two surfaces touch: an edge of one that passes through a triangle of the other.

The proof is sought where parts of the surfaces are deepest in each other: most surfaces that touch are through each
other somewhere, and one such place is enough. Finding none proves nothing.
"""

from __future__ import annotations

from math import sqrt

from harness.arrays import Ints
from harness.kernel import inner, kernel
from harness.narrowphase.gjk import Relative
from harness.narrowphase.triangle_tree import TriangleTree
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled, turned

Triangle = tuple[Vector, Vector, Vector]
Disc = tuple[Vector, float, Vector, float]
"""Centre, radius, unit normal, half the thickness along it."""

# Pairs of nodes on the way at any time, at most: two a level, and fewer than 64 levels a tree.
DEPTH = 256
# What a test of two triangles costs, in tests of two nodes.
TRIANGLES = 4


@kernel
def find_crossing(
    tree_a: TriangleTree,
    tree_b: TriangleTree,
    pose: Relative,
    start_a: int,
    start_b: int,
    margin: float,
    most: int,
    stack: Ints,
) -> tuple[int, int]:
    """A triangle of each surface, one of which an edge of the other passes through.

    Parameters
    ----------
    tree_a, tree_b : TriangleTree
    pose : Relative
    start_a, start_b : nodes below which to look
    margin : how far the edge must reach through, and stay off the triangle's border
    most : steps after which to give up
    stack : (DEPTH, 2) int array, written

    Returns
    -------
    The leaves of the two triangles; -1 if no crossing was found.
    """
    stack[0, 0], stack[0, 1] = start_a, start_b
    height, steps = 1, 0
    while height > 0 and steps < most:
        height -= 1
        a, b = stack[height, 0], stack[height, 1]
        right_a, right_b = tree_a.right[a], tree_b.right[b]
        if right_a < 0 and right_b < 0:
            steps += TRIANGLES
            if crossing(triangle_a(tree_a, pose, -1 - right_a), triangle_b(tree_b, pose, -1 - right_b), margin):
                return a, b
            continue
        steps += 1
        larger_a = right_a >= 0 and tree_a.discs[a, 3] * pose.size_a >= tree_b.discs[b, 3] * pose.size_b
        if right_b < 0 or larger_a:
            a0, b0, a1, b1 = a + 1, b, right_a, b
            disc_b = placed_b(tree_b, pose, b)
            near0, near1 = nearness(placed_a(tree_a, pose, a0), disc_b), nearness(placed_a(tree_a, pose, a1), disc_b)
        else:
            a0, b0, a1, b1 = a, b + 1, a, right_b
            disc_a = placed_a(tree_a, pose, a)
            near0, near1 = nearness(disc_a, placed_b(tree_b, pose, b0)), nearness(disc_a, placed_b(tree_b, pose, b1))
        if near0 > near1:  # the deeper one goes on top
            a0, b0, near0, a1, b1, near1 = a1, b1, near1, a0, b0, near0
        if near1 < 1.0:
            stack[height, 0], stack[height, 1] = a1, b1
            height += 1
        if near0 < 1.0:
            stack[height, 0], stack[height, 1] = a0, b0
            height += 1
    return -1, -1


@kernel
def nearness(one: Disc, two: Disc) -> float:
    """How near two discs are, squared: the smaller, the deeper they are in each other; from 1 on they are apart."""
    between = minus(two[0], one[0])
    radii = one[1] + two[1]
    squared = dot(between, between)
    if squared >= radii * radii:
        return 1.0
    cosine = dot(one[2], two[2])
    sine = sqrt(max(0.0, 1.0 - cosine * cosine)) + 1e-7  # more than rounding takes from it
    cosine = abs(cosine)
    along_one, along_two = dot(one[2], between), dot(two[2], between)
    reach_one = one[3] + two[3] * cosine + two[1] * sine
    reach_two = two[3] + one[3] * cosine + one[1] * sine
    slabs = max(along_one * along_one / (reach_one * reach_one), along_two * along_two / (reach_two * reach_two))
    return max(squared / (radii * radii), slabs)


@inner
def placed_a(tree: TriangleTree, pose: Relative, node: int) -> Disc:
    d, size = tree.discs, pose.size_a
    centre, normal = (d[node, 0], d[node, 1], d[node, 2]), (d[node, 4], d[node, 5], d[node, 6])
    return scaled(centre, size), size * d[node, 3], normal, size * d[node, 7]


@inner
def placed_b(tree: TriangleTree, pose: Relative, node: int) -> Disc:
    d, size = tree.discs, pose.size_b
    centre, normal = (d[node, 0], d[node, 1], d[node, 2]), (d[node, 4], d[node, 5], d[node, 6])
    turned_centre = scaled(turned(pose.rotation, centre), size)
    return plus(pose.offset, turned_centre), size * d[node, 3], turned(pose.rotation, normal), size * d[node, 7]


@inner
def triangle_a(tree: TriangleTree, pose: Relative, k: int) -> Triangle:
    c, size = tree.corners, pose.size_a
    return (
        scaled((c[k, 0, 0], c[k, 0, 1], c[k, 0, 2]), size),
        scaled((c[k, 1, 0], c[k, 1, 1], c[k, 1, 2]), size),
        scaled((c[k, 2, 0], c[k, 2, 1], c[k, 2, 2]), size),
    )


@inner
def triangle_b(tree: TriangleTree, pose: Relative, k: int) -> Triangle:
    c, size = tree.corners, pose.size_b
    return (
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 0, 0], c[k, 0, 1], c[k, 0, 2])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 1, 0], c[k, 1, 1], c[k, 1, 2])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 2, 0], c[k, 2, 1], c[k, 2, 2])), size)),
    )


@kernel
def crossing(one: Triangle, other: Triangle, margin: float) -> bool:
    """Whether an edge of either triangle passes through the other by more than a margin on every side."""
    return pierced(one, other, margin) or pierced(other, one, margin)


@kernel
def pierced(face: Triangle, edges: Triangle, margin: float) -> bool:
    """Whether an edge of the second triangle passes through the first."""
    a, b, c = face
    normal = cross(minus(b, a), minus(c, a))
    needed = margin * sqrt(dot(normal, normal))
    p, q, r = edges
    at_p, at_q, at_r = dot(normal, minus(p, a)), dot(normal, minus(q, a)), dot(normal, minus(r, a))
    if min(at_p, at_q, at_r) > -needed or max(at_p, at_q, at_r) < needed:
        return False
    return (
        passes(p, at_p, q, at_q, needed, face, margin)
        or passes(q, at_q, r, at_r, needed, face, margin)
        or passes(r, at_r, p, at_p, needed, face, margin)
    )


@kernel
def passes(p: Vector, at_p: float, q: Vector, at_q: float, needed: float, face: Triangle, margin: float) -> bool:
    """Whether an edge, whose ends are on given sides of a triangle's plane, goes through the triangle."""
    if not ((at_p > needed and at_q < -needed) or (at_p < -needed and at_q > needed)):
        return False
    along = minus(q, p)
    sign = 1.0 if at_q > 0.0 else -1.0
    length = sqrt(dot(along, along)) * margin
    a, b, c = face
    return (
        beside(along, p, a, b, length) * sign > 0.0
        and beside(along, p, b, c, length) * sign > 0.0
        and beside(along, p, c, a, length) * sign > 0.0
    )


@kernel
def beside(along: Vector, p: Vector, a: Vector, b: Vector, length: float) -> float:
    """On which side of the line from p an edge from a to b runs; 0 if it is too near to say."""
    side = minus(b, a)
    volume = dot(cross(along, side), minus(p, a))
    return volume if volume * volume > length * length * dot(side, side) else 0.0
