"""Distance of two surfaces, as far as it is below a limit."""

from __future__ import annotations

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.crossing import nearness, placed_a, placed_b, triangle_a, triangle_b
from harness.narrowphase.gjk import Relative
from harness.narrowphase.triangle_distance import triangle_distance
from harness.narrowphase.triangle_tree import TriangleTree


@kernel
def surface_distance(
    tree_a: TriangleTree, tree_b: TriangleTree, pose: Relative, limit: float, margin: float, stack: Ints
) -> tuple[float, int, int]:
    """The distance of two surfaces, and between which triangles.

    Parameters
    ----------
    tree_a, tree_b : TriangleTree
    pose : Relative
    limit : beyond which the distance does not matter
    margin : a distance that need not be told from 0
    stack : (DEPTH, 2) int array, written

    Returns
    -------
    distance, leaf of tree a, leaf of tree b
        inf and -1, -1 if the surfaces are farther apart than the limit.
    """
    best, best_a, best_b = np.inf, -1, -1
    stack[0, 0], stack[0, 1] = 0, 0
    height = 1
    while height > 0:
        height -= 1
        a, b = stack[height, 0], stack[height, 1]
        # what was near enough when it was put here may be so no longer
        if best < np.inf and nearness(placed_a(tree_a, pose, a), placed_b(tree_b, pose, b), limit) == 1.0:
            continue
        right_a, right_b = tree_a.right[a], tree_b.right[b]
        if right_a < 0 and right_b < 0:
            one, other = triangle_a(tree_a, pose, -1 - right_a), triangle_b(tree_b, pose, -1 - right_b)
            found = triangle_distance(one, other, margin)
            if found.upper <= limit:
                best, best_a, best_b, limit = found.upper, a, b, found.upper
                if best <= margin:
                    break
            continue
        larger_a = right_a >= 0 and tree_a.discs[a, 3] * pose.size_a >= tree_b.discs[b, 3] * pose.size_b
        if right_b < 0 or larger_a:
            a0, b0, a1, b1 = a + 1, b, right_a, b
        else:
            a0, b0, a1, b1 = a, b + 1, a, right_b
        near0 = nearness(placed_a(tree_a, pose, a0), placed_b(tree_b, pose, b0), limit)
        near1 = nearness(placed_a(tree_a, pose, a1), placed_b(tree_b, pose, b1), limit)
        if near0 > near1:  # the nearer one goes on top
            a0, b0, near0, a1, b1, near1 = a1, b1, near1, a0, b0, near0
        if near1 < 1.0:
            stack[height, 0], stack[height, 1] = a1, b1
            height += 1
        if near0 < 1.0:
            stack[height, 0], stack[height, 1] = a0, b0
            height += 1
    return best, best_a, best_b
