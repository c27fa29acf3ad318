"""Proofs that two surfaces touch, or that they do not.

That they touch is proved by an edge of one that passes through a triangle of the other. It is sought where parts of the
surfaces are deepest in each other: most surfaces that touch are through each other somewhere, and one such place is
enough. That they do not touch is proved when every part of one has been seen to be apart from every part of the other.
"""

from __future__ import annotations

from math import sqrt

from harness.arrays import Ints
from harness.kernel import inner, kernel
from harness.narrowphase.gjk import Relative
from harness.narrowphase.triangle_tree import TriangleTree
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled, turned

CROSSING, APART, UNSURE = 1, 0, 2

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
) -> tuple[int, int, int]:
    """Whether the parts of two surfaces below two nodes touch.

    Parameters
    ----------
    tree_a, tree_b : TriangleTree
    pose : Relative
    start_a, start_b : the nodes
    margin : how far an edge must reach through a triangle and stay off its border, and how far apart parts must be
    most : steps after which to give up
    stack : (DEPTH, 2) int array, written

    Returns
    -------
    CROSSING and the leaves of two triangles that do; or APART, or UNSURE, and nothing of meaning.
    """
    stack[0, 0], stack[0, 1] = start_a, start_b
    height, steps, verdict = 1, 0, APART
    while height > 0:
        if steps >= most:
            return UNSURE, -1, -1
        height -= 1
        a, b = stack[height, 0], stack[height, 1]
        right_a, right_b = tree_a.right[a], tree_b.right[b]
        if right_a < 0 and right_b < 0:
            steps += TRIANGLES
            found = meeting(triangle_a(tree_a, pose, -1 - right_a), triangle_b(tree_b, pose, -1 - right_b), margin)
            if found == CROSSING:
                return CROSSING, a, b
            verdict = max(verdict, found)
            continue
        steps += 1
        larger_a = right_a >= 0 and tree_a.discs[a, 3] * pose.size_a >= tree_b.discs[b, 3] * pose.size_b
        if right_b < 0 or larger_a:
            a0, b0, a1, b1 = a + 1, b, right_a, b
            disc_b = placed_b(tree_b, pose, b)
            near0 = nearness(placed_a(tree_a, pose, a0), disc_b, margin)
            near1 = nearness(placed_a(tree_a, pose, a1), disc_b, margin)
        else:
            a0, b0, a1, b1 = a, b + 1, a, right_b
            disc_a = placed_a(tree_a, pose, a)
            near0 = nearness(disc_a, placed_b(tree_b, pose, b0), margin)
            near1 = nearness(disc_a, placed_b(tree_b, pose, b1), margin)
        if near0 > near1:  # the deeper one goes on top
            a0, b0, near0, a1, b1, near1 = a1, b1, near1, a0, b0, near0
        if near1 < 1.0:
            stack[height, 0], stack[height, 1] = a1, b1
            height += 1
        if near0 < 1.0:
            stack[height, 0], stack[height, 1] = a0, b0
            height += 1
    return verdict, -1, -1


@kernel
def nearness(one: Disc, two: Disc, margin: float) -> float:
    """How near two discs are, squared: the smaller, the deeper they are in each other. 1 if they are a margin apart."""
    between = minus(two[0], one[0])
    squared = dot(between, between)
    cosine = dot(one[2], two[2])
    sine = sqrt(max(0.0, 1.0 - cosine * cosine)) + 1e-7  # more than rounding takes from it
    cosine = abs(cosine)
    along_one, along_two = dot(one[2], between), dot(two[2], between)
    reach = one[1] + two[1] + margin
    reach_one = one[3] + two[3] * cosine + two[1] * sine + margin
    reach_two = two[3] + one[3] * cosine + one[1] * sine + margin
    apart = (
        (squared >= reach * reach)
        | (along_one * along_one >= reach_one * reach_one)
        | (along_two * along_two >= reach_two * reach_two)
    )
    return 1.0 if apart else squared / (reach * reach)


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
def meeting(one: Triangle, other: Triangle, margin: float) -> int:
    """CROSSING if an edge of either triangle passes through the other by more than a margin on every side, APART if
    there is a wider gap between them, else UNSURE."""
    first = pierced(one, other, margin)
    if first != UNSURE:
        return first
    second = pierced(other, one, margin)
    if second != UNSURE:
        return second
    return APART if parted(one, other, margin) else UNSURE


@kernel
def pierced(face: Triangle, edges: Triangle, margin: float) -> int:
    """CROSSING if an edge of the second triangle passes through the first, APART if its plane parts them."""
    a, b, c = face
    left, right = minus(b, a), minus(c, a)
    normal = cross(left, right)
    # not by the length of the normal, which is as small as its rounding if the triangle is a needle
    needed = margin * sqrt(dot(left, left) * dot(right, right))
    p, q, r = edges
    at_p, at_q, at_r = dot(normal, minus(p, a)), dot(normal, minus(q, a)), dot(normal, minus(r, a))
    if min(at_p, at_q, at_r) > needed or max(at_p, at_q, at_r) < -needed:
        return APART
    if (
        passes(p, at_p, q, at_q, needed, face, margin)
        or passes(q, at_q, r, at_r, needed, face, margin)
        or passes(r, at_r, p, at_p, needed, face, margin)
    ):
        return CROSSING
    return UNSURE


@kernel
def parted(one: Triangle, other: Triangle, margin: float) -> bool:
    """Whether a plane along an edge of each triangle has one on either side."""
    for m in range(3):
        edge = minus(one[1], one[0]) if m == 0 else (minus(one[2], one[1]) if m == 1 else minus(one[0], one[2]))
        for n in range(3):
            along = (
                minus(other[1], other[0])
                if n == 0
                else (minus(other[2], other[1]) if n == 1 else minus(other[0], other[2]))
            )
            axis = cross(edge, along)
            needed = margin * sqrt(dot(edge, edge) * dot(along, along))
            a, b, c = dot(axis, one[0]), dot(axis, one[1]), dot(axis, one[2])
            p, q, r = dot(axis, other[0]), dot(axis, other[1]), dot(axis, other[2])
            if min(a, b, c) - max(p, q, r) > needed or min(p, q, r) - max(a, b, c) > needed:
                return True
    return False


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
