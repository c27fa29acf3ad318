"""Hierarchical grid, for bodies of different sizes: one level of cells a size class, or for a few that share it.

Within a size class bodies are nearly of a size, so that cells fit all of them; `level_choice` says when classes share a
level. Between two levels either the small bodies look into the coarse cells or the large ones into the fine cells,
whichever is less work.
"""

import numpy as np
from numpy.typing import NDArray

from harness.broadphase.uniform_grid import UniformGrid

SIZE_RATIO = 3
"""Largest to smallest body of a size class. With 2, frames of 1000 to 10^5 bodies of sizes even in the logarithm take a
fifth less over 10:1, and up to a fifth more over 100:1. With 4, a class that holds many more small bodies than large
ones gets up to 40 % slower, and with 12 two to three times as slow."""


class HierarchicalGrid(UniformGrid):
    """A size class for each factor of three. With equal sizes it is the uniform grid. See `UniformGrid`."""

    def size_classes(self) -> NDArray[np.int64]:
        """(n,) int array: 0 for bodies more than a third as large as the largest, 1 down to a ninth, and so on."""
        ratio = self.radii.max(initial=0.0) / self.radii
        classes: NDArray[np.int64] = (np.log(ratio) / np.log(SIZE_RATIO)).astype(np.int64)
        return classes
