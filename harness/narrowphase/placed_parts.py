"""Parts of two surfaces at one instant: their discs and triangles in the axes of body a, and how near they are."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel, strict_step
from harness.narrowphase.gjk import Relative
from harness.narrowphase.tree_pairs import NodePair, Proximity, Trees, halves, push_near
from harness.narrowphase.triangle_tree import TriangleTree, centre_of, normal_of, radius_of, thickness_of
from harness.narrowphase.vectors import Triangle, Vector, dot, minus, plus, scaled, turned


class Disc(NamedTuple):
    """What is below a node of a tree.

    Attributes
    ----------
    centre : from the centre of body a
    radius
    normal : unit vector
    thickness : half of it
    """

    centre: Vector
    radius: float
    normal: Vector
    thickness: float


@strict_step
def push_near_halves(trees: Trees, pose: Relative, nodes: NodePair, margin: float, stack: Ints, height: int) -> int:
    """Replace a pair of nodes by those of its halves that are not a margin apart; returns the stack's new height."""
    return push_near(stack, height, halves(trees, nodes, pose, margin, disc_a, disc_b, proximity))


@kernel
def proximity(one: Disc, two: Disc, pose: Relative, margin: float) -> Proximity:
    """Whether two discs are certainly a margin apart; the pose, in which they are placed already, is not looked at."""
    between = minus(two.centre, one.centre)
    squared = dot(between, between)
    cosine = dot(one.normal, two.normal)
    sine = sqrt(max(0.0, 1.0 - cosine * cosine)) + 1e-7  # more than rounding takes from it
    cosine = abs(cosine)
    along_one, along_two = dot(one.normal, between), dot(two.normal, between)
    reach = one.radius + two.radius + margin
    reach_one = one.thickness + two.thickness * cosine + two.radius * sine + margin
    reach_two = two.thickness + one.thickness * cosine + one.radius * sine + margin
    apart = (
        (squared >= reach * reach)
        | (along_one * along_one >= reach_one * reach_one)
        | (along_two * along_two >= reach_two * reach_two)
    )
    return Proximity(np.inf, np.inf) if apart else Proximity(0.0, squared / (reach * reach))


@strict_step
def disc_a(tree: TriangleTree, pose: Relative, node: int) -> Disc:
    size, centre = pose.size_a, centre_of(tree, node)
    return Disc(
        scaled(centre, size), size * radius_of(tree, node), normal_of(tree, node), size * thickness_of(tree, node)
    )


@strict_step
def disc_b(tree: TriangleTree, pose: Relative, node: int) -> Disc:
    size = pose.size_b
    from_b = scaled(turned(pose.rotation, centre_of(tree, node)), size)
    normal = turned(pose.rotation, normal_of(tree, node))
    return Disc(plus(pose.offset, from_b), size * radius_of(tree, node), normal, size * thickness_of(tree, node))


@strict_step
def triangle_a(tree: TriangleTree, pose: Relative, k: int) -> Triangle:
    c, size = tree.corners, pose.size_a
    return (
        scaled((c[k, 0, 0], c[k, 0, 1], c[k, 0, 2]), size),
        scaled((c[k, 1, 0], c[k, 1, 1], c[k, 1, 2]), size),
        scaled((c[k, 2, 0], c[k, 2, 1], c[k, 2, 2]), size),
    )


@strict_step
def triangle_b(tree: TriangleTree, pose: Relative, k: int) -> Triangle:
    c, size = tree.corners, pose.size_b
    return (
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 0, 0], c[k, 0, 1], c[k, 0, 2])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 1, 0], c[k, 1, 1], c[k, 1, 2])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[k, 2, 0], c[k, 2, 1], c[k, 2, 2])), size)),
    )
