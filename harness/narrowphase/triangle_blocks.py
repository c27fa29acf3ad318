"""The triangles of a surface in the order of its tree's leaves, so that those below any node stand side by side.

A search through two trees need not go down to single triangles: where few are left below a node, it takes less time to
put all of them to all of the other's, in loops over arrays, than to walk through the pairs of nodes between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel, strict_step
from harness.narrowphase.gjk import Relative
from harness.narrowphase.triangle_tree import TriangleTree
from harness.narrowphase.vectors import Triangle, plus, scaled, turned

# Triangles below a node that is not looked into any further. With 8, 16 or 64 distances take longer.
BLOCK = 32


class TriangleBlocks(NamedTuple):
    """The triangles of a tree, leaf after leaf.

    Attributes
    ----------
    first, counts : (nodes,) int array, of each node: where the triangles below it begin, and how many they are
    leaves : (f,) int array, the node of each triangle
    balls : (4, f) float array, centres and radii of spheres around the triangles
    corners : (9, f) float array, x, y, z of each corner
    """

    first: Ints
    counts: Ints
    leaves: Ints
    balls: Floats
    corners: Floats


@kernel
def triangle_blocks(tree: TriangleTree) -> TriangleBlocks:
    """The blocks of a tree."""
    nodes, faces = len(tree.right), len(tree.corners)
    first, counts, leaves = np.zeros(nodes, np.int64), np.ones(nodes, np.int64), np.empty(faces, np.int64)
    balls, corners = np.empty((4, faces)), np.empty((9, faces))
    for node in range(nodes - 1, -1, -1):  # children come after their parents
        if tree.right[node] >= 0:
            counts[node] = counts[node + 1] + counts[tree.right[node]]
    for node in range(nodes):
        right = tree.right[node]
        if right >= 0:
            first[node + 1], first[right] = first[node], first[node] + counts[node + 1]
        else:
            place = first[node]
            leaves[place] = node
            for axis in range(4):
                balls[axis, place] = tree.discs[node, axis]
            for corner in range(3):
                for axis in range(3):
                    corners[3 * corner + axis, place] = tree.corners[-1 - right, corner, axis]
    return TriangleBlocks(first, counts, leaves, balls, corners)


@strict_step
def block_triangle_a(blocks: TriangleBlocks, pose: Relative, k: int) -> Triangle:
    """The k-th triangle of body a, in the axes of a."""
    c, size = blocks.corners, pose.size_a
    return (
        scaled((c[0, k], c[1, k], c[2, k]), size),
        scaled((c[3, k], c[4, k], c[5, k]), size),
        scaled((c[6, k], c[7, k], c[8, k]), size),
    )


@strict_step
def block_triangle_b(blocks: TriangleBlocks, pose: Relative, k: int) -> Triangle:
    """The k-th triangle of body b, in the axes of a."""
    c, size = blocks.corners, pose.size_b
    return (
        plus(pose.offset, scaled(turned(pose.rotation, (c[0, k], c[1, k], c[2, k])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[3, k], c[4, k], c[5, k])), size)),
        plus(pose.offset, scaled(turned(pose.rotation, (c[6, k], c[7, k], c[8, k])), size)),
    )
