"""Distance of two surfaces, as far as it is below a limit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.gjk import Relative
from harness.narrowphase.placed_parts import disc_a, disc_b, proximity, push_near_halves, triangle_a, triangle_b
from harness.narrowphase.tree_pairs import NO_NODES, NodePair, Trees
from harness.narrowphase.triangle_distance import triangle_distance


class SurfaceDistance(NamedTuple):
    """How far two surfaces are apart.

    Attributes
    ----------
    gap : the distance; inf beyond the limit
    leaves : of the nearest triangles; -1 beyond the limit
    """

    gap: float
    leaves: NodePair


@kernel
def surface_distance(trees: Trees, pose: Relative, limit: float, margin: float, stack: Ints) -> SurfaceDistance:
    """The distance of two surfaces, and between which triangles.

    Parameters
    ----------
    trees : Trees
    pose : Relative
    limit : beyond which the distance does not matter
    margin : a distance that need not be told from 0
    stack : (DEPTH, 2) int array, written
    """
    gap, leaves = np.inf, NO_NODES
    stack[0, 0], stack[0, 1] = 0, 0
    height = 1
    while height > 0:
        height -= 1
        nodes = NodePair(stack[height, 0], stack[height, 1])
        if gap < np.inf:  # what was near enough when it was put here may be so no longer
            now = proximity(disc_a(trees.a, pose, nodes.a), disc_b(trees.b, pose, nodes.b), pose, limit)
            if now.wait > 0.0:
                continue
        right_a, right_b = trees.a.right[nodes.a], trees.b.right[nodes.b]
        if right_a < 0 and right_b < 0:
            one, other = triangle_a(trees.a, pose, -1 - right_a), triangle_b(trees.b, pose, -1 - right_b)
            found = triangle_distance(one, other, margin)
            if found.upper <= limit:
                gap, leaves, limit = found.upper, nodes, found.upper
                if gap <= margin:
                    break
        else:
            height = push_near_halves(trees, pose, nodes, limit, stack, height)
    return SurfaceDistance(gap, leaves)
