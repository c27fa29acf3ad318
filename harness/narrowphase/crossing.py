"""Proofs that two surfaces touch, or that they do not.

That they touch is proved by an edge of one that passes through a triangle of the other. It is searched for where parts
of the surfaces are deepest in each other: most surfaces that touch are through each other somewhere, and one such place
is enough. That they do not touch is proved when every part of one has been seen to be apart from every part of the
other.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.gjk import Relative
from harness.narrowphase.placed_parts import push_near_halves, triangle_a, triangle_b
from harness.narrowphase.tree_pairs import NO_NODES, NodePair, Trees
from harness.narrowphase.vectors import Triangle, Vector, cross, dot, minus
from harness.narrowphase.verdicts import PairVerdict

# What a test of two triangles costs, in tests of two nodes.
TRIANGLES = 4


class Crossing(NamedTuple):
    """Whether two surfaces touch.

    Attributes
    ----------
    verdict : TOUCHING, if an edge of one passes through a triangle of the other; SEPARATE or UNDECIDED
    leaves : of the two triangles; of no meaning where none are known to cross
    """

    verdict: PairVerdict
    leaves: NodePair


@kernel
def find_crossing(
    trees: Trees, pose: Relative, start: NodePair, margin: float, most_steps: int, stack: Ints
) -> Crossing:
    """Whether the parts of two surfaces below two nodes touch.

    Parameters
    ----------
    trees : Trees
    pose : Relative
    start : the nodes
    margin : how far an edge must reach through a triangle and stay off its border, and how far apart parts must be
    most_steps : after which to give up
    stack : (DEPTH, 2) int array, written
    """
    stack[0, 0], stack[0, 1] = start
    height, steps, undecided = 1, 0, False
    while height > 0:
        if steps >= most_steps:
            return Crossing(PairVerdict.UNDECIDED, NO_NODES)
        height -= 1
        nodes = NodePair(stack[height, 0], stack[height, 1])
        right_a, right_b = trees.a.right[nodes.a], trees.b.right[nodes.b]
        if right_a < 0 and right_b < 0:
            steps += TRIANGLES
            found = meeting(triangle_a(trees.a, pose, -1 - right_a), triangle_b(trees.b, pose, -1 - right_b), margin)
            if found == PairVerdict.TOUCHING:
                return Crossing(PairVerdict.TOUCHING, nodes)
            undecided |= found == PairVerdict.UNDECIDED
        else:
            steps += 1
            height = push_near_halves(trees, pose, nodes, margin, stack, height)
    return Crossing(PairVerdict.UNDECIDED if undecided else PairVerdict.SEPARATE, NO_NODES)


@kernel
def meeting(one: Triangle, other: Triangle, margin: float) -> PairVerdict:
    """TOUCHING if an edge of either triangle passes through the other by more than a margin on every side, SEPARATE if
    there is a wider gap between them, else UNDECIDED."""
    first = pierced(one, other, margin)
    if first != PairVerdict.UNDECIDED:
        return first
    second = pierced(other, one, margin)
    if second != PairVerdict.UNDECIDED:
        return second
    return PairVerdict.SEPARATE if parted(one, other, margin) else PairVerdict.UNDECIDED


@kernel
def pierced(face: Triangle, edges: Triangle, margin: float) -> PairVerdict:
    """TOUCHING if an edge of the second triangle passes through the first, SEPARATE if its plane parts them."""
    a, b, c = face
    left, right = minus(b, a), minus(c, a)
    normal = cross(left, right)
    # not by the length of the normal, which is as small as its rounding if the triangle is a needle
    needed = margin * sqrt(dot(left, left) * dot(right, right))
    p, q, r = edges
    at_p, at_q, at_r = dot(normal, minus(p, a)), dot(normal, minus(q, a)), dot(normal, minus(r, a))
    if min(at_p, at_q, at_r) > needed or max(at_p, at_q, at_r) < -needed:
        return PairVerdict.SEPARATE
    if (
        passes(p, at_p, q, at_q, needed, face, margin)
        or passes(q, at_q, r, at_r, needed, face, margin)
        or passes(r, at_r, p, at_p, needed, face, margin)
    ):
        return PairVerdict.TOUCHING
    return PairVerdict.UNDECIDED


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
