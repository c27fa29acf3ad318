"""All pairs, near or not: what passes on everything, for methods that put every pair to the exact shape."""

import numpy as np
from numpy.typing import ArrayLike

from harness.arrays import Pairs


class AllPairs:
    """Every pair, every frame. In the form of a `BroadPhase`, but nothing is culled.

    Parameters
    ----------
    count : of bodies

    Examples
    --------
    >>> AllPairs(3).close_pairs(np.zeros((3, 3))).tolist()
    [[0, 1], [0, 2], [1, 2]]
    """

    def __init__(self, count: int) -> None:
        self.pair_tests = 0
        first, second = np.triu_indices(count, 1)
        self._pairs: Pairs = np.column_stack([first, second]).astype(np.int64)

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """All pairs (k, 2), i < j, sorted, wherever the bodies are."""
        self.pair_tests += len(self._pairs)
        return self._pairs
