"""Uniform grid: which bodies are close enough to touch.

Cells are as large as the largest body, so that a body meets at most its own and the 26 neighbouring cells. Bodies of
very different sizes crowd such cells; `HierarchicalGrid` keeps them apart.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.arrays import Floats, Pairs
from harness.broadphase import cells
from harness.broadphase.cell_order import ROW, Cells
from harness.broadphase.levels import LEVEL, Levels
from harness.broadphase.pairs import checked_positions, checked_radii, unpack
from harness.scene.box import Box
from harness.threads import Threads

CELLS_PER_BODY = 8
"""Cells that all levels together may have for each body; in a dilute scene cells grow until they keep to it."""

FEWEST_SHARED = 32768
"""Bodies that are worth handing over to another thread."""


class UniformGrid:
    """Cells sized to the largest body, rebuilt every frame in O(n). See `BroadPhase`.

    Parameters
    ----------
    radii : (n,) array, m
    box : Box
        Where the bodies are expected. Those outside are found all the same, if many of them more slowly.
    """

    def __init__(self, radii: ArrayLike, box: Box) -> None:
        self.radii = checked_radii(radii)
        self.pair_tests = 0
        count = len(self.radii)
        level = self.size_classes()
        members = np.argsort(level, kind="stable")
        levels = plan_levels(self.radii[members], level[members])
        self._half = np.array(box.half, np.float64)
        self._arrays: cells.Arrays = (
            members.astype(np.int32),
            self.radii[members],
            levels,
            np.empty(int(levels["class_budget"].sum()) + 1, np.int32),
            np.empty(count, np.int32),
            np.empty(count, ROW),
            np.empty((count, 2), np.int32),
            np.zeros((4, count + cells.FIRST)),
        )
        self._cells = Cells(*self._arrays)
        self._keys = np.empty(count + 1, np.int64)
        self._threads, self._of_parts = Threads(), [np.empty(0, np.int64)]

    def share_with(self, threads: Threads) -> None:
        """Share out the bodies of a frame among threads from now on; pairs, their order and counts stay the same."""
        self._threads = threads

    def compile_shared(self) -> None:
        """Compile what threads call."""
        self._shared(np.zeros((len(self.radii), 3)), 1)

    def size_classes(self) -> NDArray[np.int64]:
        """(n,) int array: the size class of each body, 0 the largest. Here all bodies are in one."""
        return np.zeros(len(self.radii), np.int64)

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """Pairs of bodies whose bounding spheres touch, as `BroadPhase.close_pairs` defines them."""
        positions = checked_positions(positions, len(self.radii))
        parts = len(self._threads.parts(len(self.radii), FEWEST_SHARED))
        if parts > 1:
            return self._shared(positions, parts)
        close, tests = cells.close_pairs(positions, self._half, self._arrays, self._keys)
        if close > len(self._keys):  # count first, then make room: rare, as the room is kept
            self._keys = np.empty(close + close // 2, np.int64)
            cells.close_pairs(positions, self._half, self._arrays, self._keys)
        self.pair_tests += tests
        keys = self._keys[:close]
        keys.sort()
        return unpack(keys)

    def _shared(self, positions: Floats, parts: int) -> Pairs:
        """The same, with the bodies of every level shared out among threads in so many parts."""
        cells.sort_into_cells(positions, self._half, self._arrays)
        while len(self._of_parts) < parts:
            self._of_parts.append(np.empty(0, np.int64))

        def search(part: int, _: int) -> tuple[int, int]:
            close, tests = cells.close_pairs_of_part(self._arrays, self._of_parts[part], part, parts)
            if close > len(self._of_parts[part]):
                self._of_parts[part] = np.empty(close + close // 2, np.int64)
                cells.close_pairs_of_part(self._arrays, self._of_parts[part], part, parts)
            return close, tests

        found = self._threads.each(search, tuple((part, part + 1) for part in range(parts)))
        self.pair_tests += sum(tests for _, tests in found)
        keys = np.concatenate([self._of_parts[part][:close] for part, (close, _) in enumerate(found)])
        keys.sort()
        return unpack(keys)

    @property
    def cell_count(self) -> int:
        """Cells of all levels in the last frame, the empty ones at the borders included."""
        return int(self._cells.levels["cells"].sum())

    def cells_per_body(self) -> tuple[int, float]:
        """How many cells of its own level a body's bounding cube overlapped in the last frame: the most, and the mean.

        At most 8, as a cell is never smaller than a body. The lattice ends with the outermost centres, and what sticks
        out is in no cell.
        """
        overlapped = cells.count_overlapped(self._cells.levels, self._cells.columns)
        return overlapped.most, overlapped.total / max(1, len(self.radii))


def plan_levels(radii: Floats, level: NDArray[np.int64]) -> Levels:
    """(levels,) of LEVEL from the bodies in the order of their size class: how large, whose slots, how many cells.

    Half of the cells are shared out by population. The other half equally, or the lattice of a few large bodies among
    many small ones would be so coarse that every small one is tested with every large one.
    """
    count = len(level)
    _, begin = np.unique(level, return_index=True)
    begin = begin if count else np.zeros(1, np.int64)
    levels = np.zeros(len(begin), LEVEL)
    levels["class_begin"] = begin
    levels["class_end"] = np.append(begin[1:], count)
    levels["reach"] = np.maximum.reduceat(radii, begin) if count else 1.0
    levels["class_least"] = np.minimum.reduceat(radii, begin) if count else 1.0
    share = (levels["class_end"] - levels["class_begin"] + count / len(levels)) / 2
    levels["class_budget"] = 8 + CELLS_PER_BODY * share  # a lattice of one cell needs 8, with its empty border
    return levels
