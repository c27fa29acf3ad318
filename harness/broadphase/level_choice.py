"""Which size classes share a level, chosen every frame: fewer levels are fewer lattices to look into.

Few bodies in much space have cells larger than they are, as there may be only so many cells. Where smaller bodies share
them, hardly more pairs are tested than between two levels, and nobody looks into a second lattice.
"""

from harness.arrays import Floats
from harness.broadphase.levels import Level, Levels, bounds, cells_covered, cells_of, fit_cells, within_box
from harness.kernel import kernel

FEWEST_BODIES = 500
"""Bodies whose levels are worth a choice: the frame of fewer takes some 30 us, of which there is little to save."""

VISIT = 9.0
"""Steps that it takes a body to look into another lattice at all, beyond those that decide which of two levels seeks.

A step is some 2.3 ns. Measured on 100 pairs of levels: 31 ns a body, 1.4 a row of cells and 1.3 a test."""


@kernel
def fit_lattices(positions: Floats, half: Floats, levels: Levels) -> None:
    """Spread each level's lattice over the part of the box where bodies are; all positions must be finite.

    Bodies beyond the walls belong to the border cells, so that one that has shot far out does not thin out the lattice.
    """
    low, high = bounds(positions, half)
    x, wide = within_box(low[0], high[0], half[0])
    y, deep = within_box(low[1], high[1], half[1])
    z, tall = within_box(low[2], high[2], half[2])
    choose_levels(levels, wide, deep, tall)
    first = 0
    for index in range(len(levels)):
        level = levels[index]
        level.low_x, level.low_y, level.low_z = x, y, z
        level.first = first
        first += level.cells


@kernel
def choose_levels(levels: Levels, wide: float, deep: float, tall: float) -> None:
    """Fit cells to each size class; give it to the level of the class before it where that is less work.

    A level without bodies is left of a class that was given away.
    """
    taker = 0
    for index in range(len(levels)):
        level = levels[index]
        level.begin, level.end = level.class_begin, level.class_end
        level.least, level.budget = level.class_least, level.class_budget
        fit_cells(level, wide, deep, tall)
        if index > 0 and levels[-1].class_end >= FEWEST_BODIES:
            if takes(levels[taker], level, wide, deep, tall):
                level.begin, level.cells = level.end, 0
            else:
                taker = index


@kernel
def takes(level: Level, smaller: Level, wide: float, deep: float, tall: float) -> bool:
    """Let a level have the bodies of the next smaller one as well, if that is less work than both levels by themselves.

    Returns whether it has them.
    """
    apart = work_within(level) + work_within(smaller)
    apart += min(expected_work(level, smaller), expected_work(smaller, level))
    apart += VISIT * min(level.end - level.begin, smaller.end - smaller.begin)
    end, least, budget = level.end, level.least, level.budget
    level.end, level.least, level.budget = smaller.end, smaller.least, budget + smaller.budget
    fit_cells(level, wide, deep, tall)
    if work_within(level) <= apart:
        return True
    level.end, level.least, level.budget = end, least, budget
    fit_cells(level, wide, deep, tall)
    return False


@kernel
def work_within(level: Level) -> float:
    """Steps that `pairs_within` can be expected to take: five runs of cells, and half of the bodies in 27 cells."""
    bodies = level.end - level.begin
    return float(bodies * (5.0 + 13.5 * bodies / cells_of(level)))


@kernel
def expected_work(seekers: Level, others: Level) -> float:
    """Steps that `pairs_between` can be expected to take: rows of cells looked into, and bodies tested there."""
    reach = seekers.reach + others.reach
    rows = cells_covered(reach, others.scale_x, others.last_x) * cells_covered(reach, others.scale_y, others.last_y)
    bodies = cells_covered(reach, others.scale_z, others.last_z) * (others.end - others.begin) / others.cells
    return float((seekers.end - seekers.begin) * (4.0 + rows * (1.0 + bodies)))  # 4: to find the first cell
