"""Distance of two surfaces and their nearest triangles, warm-started, as far as it is below a limit.

A descent through both trees at once, the nearer halves first. Every pair of nodes has a bound below which its triangles
cannot come, and is left where that is no less than the least distance found so far. The bound of discs is the greatest
of three, of which each splits the way between two points in a part along an axis and a part across it: the normals of
both discs, and the direction of the least distance so far, along which most of two surfaces that bulge towards each
other is seen to be farther apart. A search that begins with the nearest triangles of an earlier one has little to do
but to prove that they are nearest still.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel, strict_step
from harness.narrowphase.gjk import Relative
from harness.narrowphase.placed_parts import Disc, disc_a, disc_b
from harness.narrowphase.tree_pairs import DEPTH, NO_NODES, NodePair, Trees
from harness.narrowphase.triangle_blocks import BLOCK, TriangleBlocks, block_triangle_a, block_triangle_b
from harness.narrowphase.triangle_distance import walk
from harness.narrowphase.triangle_tree import TriangleTree, radius_of
from harness.narrowphase.vectors import Vector, dot, minus, scaled, turned_back

# How many times as wide as the other a node may be, to be left whole though it has few triangles: of a floor or a wall
# each triangle by itself shows that most of a small body is far from it.
WIDE = 4.0
# Relative surplus of a limit, so that rounding leaves out nothing that is just as far.
SURPLUS = 1e-15


class Blocks(NamedTuple):
    """The triangles of bodies a and b."""

    a: TriangleBlocks
    b: TriangleBlocks


class SearchScratch(NamedTuple):
    """What a search writes to.

    Attributes
    ----------
    nodes : (DEPTH, 2) int array, pairs of nodes that are yet to be looked at
    bounds : (DEPTH,) float array, of each the square of what it cannot come below
    parts : (4, BLOCK) float array, of each triangle of a block how far it reaches along an axis, and the centre of the
        sphere around it
    """

    nodes: Ints
    bounds: Floats
    parts: Floats


class Nearness(NamedTuple):
    """How near two discs can come.

    Attributes
    ----------
    bound : the square of what they cannot come below
    centres : the square of how far their centres are apart, of their reaches
    """

    bound: float
    centres: float


class SurfaceGap(NamedTuple):
    """How far two surfaces are apart.

    Attributes
    ----------
    lower, gap : bounds on the distance; inf beyond the limit
    axis : unit vector from b to a, of the shortest connection; of no meaning beyond the limit
    leaves : of the nearest triangles; -1 beyond the limit
    """

    lower: float
    gap: float
    axis: Vector
    leaves: NodePair


@kernel
def search_scratch() -> SearchScratch:
    """Uninitialised."""
    return SearchScratch(np.empty((DEPTH, 2), np.int64), np.empty(DEPTH), np.empty((4, BLOCK)))


@kernel
def surface_gap(
    trees: Trees,
    blocks: Blocks,
    pose: Relative,
    start: NodePair,
    axis: Vector,
    limit: float,
    enough: float,
    tolerance: float,
    scratch: SearchScratch,
) -> SurfaceGap:
    """The distance of two surfaces, and between which triangles.

    Parameters
    ----------
    trees, blocks : Trees and their Blocks
    pose : Relative
    start : leaves to begin with, or NO_NODES. They only save time.
    axis : unit vector, a guess at the direction from b to a. It only saves time.
    limit : beyond which the distance does not matter
    enough : a distance that need not be known better, such as one that cannot be told from 0
    tolerance : how much smaller than `gap` the distance may be
    scratch : written

    Returns
    -------
    SurfaceGap
        With `gap` - `lower` within the tolerance, and rounding of 1e-14 of the distance, unless `gap` is `enough`.
    """
    best = SurfaceGap(np.inf, np.inf, axis, NO_NODES)
    limit += SURPLUS * limit
    if start.a >= 0:
        first, other = blocks.a.first[start.a], blocks.b.first[start.b]
        best, limit = nearer_triangles(blocks, pose, first, other, enough, tolerance, best, limit)
        if enough < best.gap < np.inf:  # those next to them are mostly nearest now: a tenth less time
            around = NodePair(around_leaf(trees.a, blocks.a, start.a), around_leaf(trees.b, blocks.b, start.b))
            best, limit = nearest_of_blocks(blocks, pose, around, enough, tolerance, best, limit, scratch.parts)
    scratch.nodes[0, 0], scratch.nodes[0, 1], scratch.bounds[0] = 0, 0, 0.0
    height = 1
    while height > 0 and best.gap > enough:
        height -= 1
        if scratch.bounds[height] >= limit * limit:
            continue
        nodes = NodePair(scratch.nodes[height, 0], scratch.nodes[height, 1])
        halve_a, halve_b = to_be_halved(trees, blocks, pose, nodes)
        if not (halve_a or halve_b):
            best, limit = nearest_of_blocks(blocks, pose, nodes, enough, tolerance, best, limit, scratch.parts)
        else:
            height = push_halves(trees, blocks, pose, nodes, best.axis, limit * limit, scratch, height)
    return best


@strict_step
def around_leaf(tree: TriangleTree, blocks: TriangleBlocks, leaf: int) -> int:
    """The largest node above a leaf whose triangles are put to all of another."""
    node = leaf
    while node > 0 and blocks.counts[tree.parent[node]] <= BLOCK:
        node = tree.parent[node]
    return node


@strict_step
def to_be_halved(trees: Trees, blocks: Blocks, pose: Relative, nodes: NodePair) -> tuple[bool, bool]:
    """Whether there are too many triangles below either node, or these are too wide, to put all to all of the other."""
    count_a, count_b = blocks.a.counts[nodes.a], blocks.b.counts[nodes.b]
    radius_a = radius_of(trees.a, nodes.a) * pose.size_a
    radius_b = radius_of(trees.b, nodes.b) * pose.size_b
    wide_a, wide_b = count_a > 1 and radius_a > WIDE * radius_b, count_b > 1 and radius_b > WIDE * radius_a
    return count_a > BLOCK or wide_a, count_b > BLOCK or wide_b


@strict_step
def push_halves(
    trees: Trees,
    blocks: Blocks,
    pose: Relative,
    nodes: NodePair,
    axis: Vector,
    squared_limit: float,
    scratch: SearchScratch,
    height: int,
) -> int:
    """Replace a pair of nodes by those of its halves that may come below a limit; returns the stack's new height."""
    a, b = nodes
    halve_a, halve_b = to_be_halved(trees, blocks, pose, nodes)
    larger_a = radius_of(trees.a, a) * pose.size_a >= radius_of(trees.b, b) * pose.size_b
    if not halve_b or (halve_a and larger_a):
        left, right = NodePair(a + 1, b), NodePair(trees.a.right[a], b)
        whole = disc_b(trees.b, pose, b)
        of_left = nearness(disc_a(trees.a, pose, left.a), whole, axis, squared_limit)
        of_right = nearness(disc_a(trees.a, pose, right.a), whole, axis, squared_limit)
    else:
        left, right = NodePair(a, b + 1), NodePair(a, trees.b.right[b])
        whole = disc_a(trees.a, pose, a)
        of_left = nearness(whole, disc_b(trees.b, pose, left.b), axis, squared_limit)
        of_right = nearness(whole, disc_b(trees.b, pose, right.b), axis, squared_limit)
    if of_left.bound > of_right.bound or (of_left.bound == of_right.bound and of_left.centres > of_right.centres):
        left, of_left, right, of_right = right, of_right, left, of_left
    if of_right.bound < squared_limit:
        scratch.nodes[height, 0], scratch.nodes[height, 1], scratch.bounds[height] = right.a, right.b, of_right.bound
        height += 1
    if of_left.bound < squared_limit:
        scratch.nodes[height, 0], scratch.nodes[height, 1], scratch.bounds[height] = left.a, left.b, of_left.bound
        height += 1
    return height


@kernel
def nearness(one: Disc, two: Disc, axis: Vector, squared_limit: float) -> Nearness:
    """How near two discs can come. The bound is as great as can be only where it is below the limit."""
    between = minus(two.centre, one.centre)
    squared = dot(between, between)
    reach = one.radius + two.radius
    bound = max(0.0, sqrt(squared) - reach) ** 2
    near = squared / (reach * reach)
    if bound < squared_limit:
        cosine_one, cosine_two = dot(one.normal, axis), dot(two.normal, axis)
        extent = extent_along(one, cosine_one) + extent_along(two, cosine_two)
        bound = max(bound, split(dot(axis, between), squared, extent, reach))
    if bound < squared_limit:
        cosine = dot(one.normal, two.normal)
        along = dot(one.normal, between)
        bound = max(bound, split(along, squared, one.thickness + extent_along(two, cosine), reach))
        along = dot(two.normal, between)
        bound = max(bound, split(along, squared, two.thickness + extent_along(one, cosine), reach))
    return Nearness(bound, near)


@strict_step
def extent_along(disc: Disc, cosine: float) -> float:
    """How far a disc reaches from its centre along an axis, given the cosine of the axis and its normal."""
    sine = sqrt(max(0.0, 1.0 - cosine * cosine)) + 1e-7  # more than rounding takes from it
    return disc.thickness * abs(cosine) + disc.radius * sine


@strict_step
def split(along: float, squared: float, extent: float, reach: float) -> float:
    """A bound, squared, from the ways between two discs along an axis and across it.

    Parameters
    ----------
    along : the way between the centres along the axis
    squared : the whole way between them
    extent : how far both reach along the axis
    reach : how far both reach across it
    """
    apart = max(0.0, abs(along) - extent)
    across = max(0.0, sqrt(max(0.0, squared - along * along)) - reach)
    return apart * apart + across * across


@kernel
def nearest_of_blocks(
    blocks: Blocks,
    pose: Relative,
    nodes: NodePair,
    enough: float,
    tolerance: float,
    best: SurfaceGap,
    limit: float,
    parts: Floats,
) -> tuple[SurfaceGap, float]:
    """The best so far and its limit, or those of the nearest triangles below two nodes, if these are nearer."""
    a, b, axis = blocks.a, blocks.b, best.axis
    begin_a, begin_b, count = a.first[nodes.a], b.first[nodes.b], b.counts[nodes.b]
    highest = place_block(b, pose, begin_b, count, axis, parts)
    x, y, z = scaled(axis, pose.size_a)
    c, size = a.corners, pose.size_a
    for i in range(begin_a, begin_a + a.counts[nodes.a]):
        low = min(
            min(x * c[0, i] + y * c[1, i] + z * c[2, i], x * c[3, i] + y * c[4, i] + z * c[5, i]),
            x * c[6, i] + y * c[7, i] + z * c[8, i],
        )
        if low - highest >= limit:
            continue
        at_x, at_y, at_z, radius = (
            size * a.balls[0, i],
            size * a.balls[1, i],
            size * a.balls[2, i],
            size * a.balls[3, i],
        )
        for j in range(count):
            gap = low - parts[0, j]
            between = parts[1, j] - at_x, parts[2, j] - at_y, parts[3, j] - at_z
            reach = radius + pose.size_b * b.balls[3, begin_b + j]
            squared = dot(between, between)
            if gap >= limit or squared >= (reach + limit) * (reach + limit):
                continue
            if gap > 0.0:
                along = dot(axis, between)
                across = sqrt(max(0.0, squared - along * along)) - reach
                if across > 0.0 and gap * gap + across * across >= limit * limit:
                    continue
            best, limit = nearer_triangles(blocks, pose, i, begin_b + j, enough, tolerance, best, limit)
            if best.gap <= enough:
                return best, limit
    return best, limit


@strict_step
def place_block(blocks: TriangleBlocks, pose: Relative, begin: int, count: int, axis: Vector, parts: Floats) -> float:
    """Place triangles of body b in the axes of a: how far they reach along an axis, and the spheres around them.

    Returns how far the farthest reaches.
    """
    c, q, size = blocks.corners, blocks.balls, pose.size_b
    x, y, z = scaled(turned_back(pose.rotation, axis), size)
    lift, turn, highest = dot(axis, pose.offset), pose.rotation, -np.inf
    for j in range(count):
        k = begin + j
        high = max(
            max(x * c[0, k] + y * c[1, k] + z * c[2, k], x * c[3, k] + y * c[4, k] + z * c[5, k]),
            x * c[6, k] + y * c[7, k] + z * c[8, k],
        )
        parts[0, j] = lift + high
        highest = max(highest, lift + high)
        centre = size * q[0, k], size * q[1, k], size * q[2, k]
        parts[1, j] = pose.offset[0] + dot(turn[0], centre)
        parts[2, j] = pose.offset[1] + dot(turn[1], centre)
        parts[3, j] = pose.offset[2] + dot(turn[2], centre)
    return highest


@kernel
def nearer_triangles(
    blocks: Blocks,
    pose: Relative,
    i: int,
    j: int,
    enough: float,
    tolerance: float,
    best: SurfaceGap,
    limit: float,
) -> tuple[SurfaceGap, float]:
    """The best so far and its limit, or those of two triangles, by their places in the blocks, if these are nearer."""
    one, other = block_triangle_a(blocks.a, pose, i), block_triangle_b(blocks.b, pose, j)
    found = walk(one, other, best.axis, enough, limit)
    lower = min(best.lower, found.lower)
    if found.upper > limit:
        return SurfaceGap(best.lower if found.lower >= limit else lower, best.gap, best.axis, best.leaves), limit
    limit = min(limit, max(0.0, found.upper - tolerance))
    leaves = NodePair(blocks.a.leaves[i], blocks.b.leaves[j])
    return SurfaceGap(min(lower, limit), found.upper, found.axis, leaves), limit
