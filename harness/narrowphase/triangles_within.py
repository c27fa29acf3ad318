"""Whether any two triangles of two surfaces are within a distance of each other: a proof that the surfaces are.

How far the surfaces are apart is another question, which takes longer: `surface_gap`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.gjk import Relative
from harness.narrowphase.placed_parts import push_near_halves, triangle_a, triangle_b
from harness.narrowphase.tree_pairs import NO_NODES, NodePair, Trees
from harness.narrowphase.triangle_distance import triangle_distance


class TrianglesWithin(NamedTuple):
    """Two triangles that are within a limit.

    Attributes
    ----------
    gap : the distance of the triangles, which that of the surfaces does not exceed; inf if none are within the limit
    leaves : of the triangles; -1 if none are
    """

    gap: float
    leaves: NodePair


@kernel
def triangles_within(trees: Trees, pose: Relative, limit: float, margin: float, stack: Ints) -> TrianglesWithin:
    """The first two triangles found that are within a limit.

    Parameters
    ----------
    trees : Trees
    pose : Relative
    limit : a distance
    margin : a distance that need not be told from 0
    stack : (DEPTH, 2) int array, written
    """
    stack[0, 0], stack[0, 1] = 0, 0
    height = 1
    while height > 0:
        height -= 1
        nodes = NodePair(stack[height, 0], stack[height, 1])
        if trees.a.right[nodes.a] < 0 and trees.b.right[nodes.b] < 0:
            gap = gap_of_leaves(trees, pose, nodes, margin)
            if gap <= limit:
                return TrianglesWithin(gap, nodes)
        else:
            height = push_near_halves(trees, pose, nodes, limit, stack, height)
    return TrianglesWithin(np.inf, NO_NODES)


@kernel
def gap_of_leaves(trees: Trees, pose: Relative, nodes: NodePair, margin: float) -> float:
    """The distance of the triangles of two leaves; inf of nodes that have more below them."""
    right_a, right_b = trees.a.right[nodes.a], trees.b.right[nodes.b]
    if right_a >= 0 or right_b >= 0:
        return np.inf
    one, other = triangle_a(trees.a, pose, -1 - right_a), triangle_b(trees.b, pose, -1 - right_b)
    return triangle_distance(one, other, margin).upper
