"""Cells: the kernels under both grids. Bodies are sorted by cell, and only neighbouring cells are compared.

Bodies belong to levels, the largest first. Every level has a lattice of its own over the same space, with cells at
least as large as its largest body, so that two of its bodies touch only from the same cell or from neighbouring ones.
The cells of all levels are numbered on, so that one counting sort a frame puts every body in its place. The uniform
grid has one level.
"""

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.broadphase.cell_order import Cells, Indices, Rows, sort_by_cell
from harness.broadphase.lanes import LANES, lanes_within, lowest_bit
from harness.broadphase.levels import SLACK, Level, Levels, block_around, cells_covered, fit_lattices
from harness.broadphase.pairs import NEARLY, Keys, touching
from harness.kernel import inner, kernel

RUNS = 5
"""Of three cells along z, with whose bodies one of the same level is compared: its own, and four later neighbours."""


Arrays = tuple[Indices, Floats, Levels, Indices, Indices, Rows, Indices, Floats]


class Found(NamedTuple):
    """How many pairs are close, and how many were tested."""

    close: int
    tests: int


@kernel
def close_pairs(positions: Floats, half: Floats, bodies: Arrays, keys: Keys) -> tuple[int, int]:
    """Sort the bodies into cells and test neighbours.

    Parameters
    ----------
    positions : (n, 3), m
    half : (3,), m; half the sides of the box
    bodies : the arrays of `Cells`, and the answer is as in `Found`. Tuples without names cross from Python in half the
        time, which is a fifth of a frame of 30 bodies
    keys : (room,) written: i << 32 | j of each close pair, in no order, as far as there is room
    """
    sort_into_cells(positions, half, bodies)
    return close_pairs_of_part(bodies, keys, 0, 1)


@kernel
def sort_into_cells(positions: Floats, half: Floats, bodies: Arrays) -> None:
    """Fit the lattices and sort the bodies; arguments are as for `close_pairs`."""
    cells = Cells(*bodies)
    fit_lattices(positions, half, cells.levels)
    sort_by_cell(positions, cells)


@kernel
def close_pairs_of_part(bodies: Arrays, keys: Keys, part: int, parts: int) -> tuple[int, int]:
    """Test the neighbours of one of so many equal parts of the bodies of every level, as they are sorted.

    `bodies`, `keys` and the answer are as for `close_pairs`, which has one part.
    """
    cells = Cells(*bodies)
    levels = cells.levels
    close, tests = 0, 0
    for fine in range(len(levels)):
        level = levels[fine]
        begin, end = part_of(level, part, parts)
        close, tests = pairs_within(level, begin, end, cells, keys, close, tests)
        for coarse in range(fine):
            seekers, others = levels[fine], levels[coarse]
            if expected_work(others, seekers) < expected_work(seekers, others):
                seekers, others = others, seekers
            begin, end = part_of(seekers, part, parts)
            close, tests = pairs_between(seekers, others, begin, end, cells, keys, close, tests)
    return close, tests


@kernel
def part_of(level: Level, part: int, parts: int) -> tuple[int, int]:
    """The slots where a part of the bodies of a level begins and ends."""
    count = level.end - level.begin
    return level.begin + count * part // parts, level.begin + count * (part + 1) // parts


@kernel
def pairs_within(level: Level, first: int, last: int, cells: Cells, keys: Keys, close: int, tests: int) -> Found:
    """Each body with those after it in its own cell, and with the later half of the neighbouring cells.

    The first bodies of all runs are compared before any pair is written: whether one is near cannot be foreseen, and a
    branch for each run would be mispredicted. Cells are unsigned as indices, or numba would ask of each whether it
    counts from the end, which takes a quarter of the time.

    Parameters and answer: the slots from `first` until `last`; `close` pairs and `tests` so far, and with those of
    this level.
    """
    start, slots, columns = cells.start, cells.slots, cells.columns
    row, plane = level.row, level.plane
    begins, ends = np.empty(RUNS, np.int64), np.empty(RUNS, np.int64)
    for slot in range(first, last):
        cell = slots[slot, 0]
        x, y, z = columns[0, slot], columns[1, slot], columns[2, slot]
        square = NEARLY * (columns[3, slot] + level.reach) ** 2
        near, longest = 0, 0
        for run in range(RUNS):
            middle = cell + (run * row if run < 2 else plane + (run - 3) * row)
            begin, end = slot + 1, start[np.uintp(middle + 2)]
            if run > 0:
                begin = start[np.uintp(middle - 1)]
            begins[run], ends[run] = begin, end
            bodies = end - begin
            within = lanes_within(columns, begin, x, y, z, square) & ((1 << min(bodies, LANES)) - 1)
            near |= within << (run * LANES)
            longest = max(longest, bodies)
            tests += bodies
        while near != 0:
            bit = lowest_bit(near)
            near &= near - 1
            other = begins[bit // LANES] + bit % LANES
            close = compare(slot, other, other + 1, square, cells, keys, close)
        if longest > LANES:
            for run in range(RUNS):
                close = compare(slot, begins[run] + LANES, ends[run], square, cells, keys, close)
    return Found(close, tests)


@kernel
def pairs_between(
    seekers: Level, others: Level, begin: int, end: int, cells: Cells, keys: Keys, close: int, tests: int
) -> Found:
    """Each body of one level with the bodies of the other in all cells where their centres can be.

    Either level may seek. Many small bodies each look into a few cells of the coarse lattice, but a few large ones do
    less work if they go through the fine cells that they cover. The seekers are those in the slots from `begin` until
    `end`; `close` and `tests` are as for `pairs_within`.
    """
    start, columns = cells.start, cells.columns
    for slot in range(begin, end):
        x, y, z = columns[0, slot], columns[1, slot], columns[2, slot]
        reach = (columns[3, slot] + others.reach) * (1.0 + SLACK)
        square = NEARLY * reach * reach
        block = block_around(others, x, y, z, reach)
        first, last = others.first + block.x0 * others.plane, others.first + block.x1 * others.plane
        for plane in range(first, last + 1, others.plane):
            for row in range(plane + block.y0 * others.row, plane + block.y1 * others.row + 1, others.row):
                low, high = start[np.uintp(row + block.z0)], start[np.uintp(row + block.z1 + 1)]
                bodies = high - low
                tests += bodies
                near = lanes_within(columns, low, x, y, z, square) & ((1 << min(bodies, LANES)) - 1)
                while near != 0:
                    other = low + lowest_bit(near)
                    near &= near - 1
                    close = compare(slot, other, other + 1, square, cells, keys, close)
                if bodies > LANES:
                    close = compare(slot, low + LANES, high, square, cells, keys, close)
    return Found(close, tests)


@kernel
def expected_work(seekers: Level, others: Level) -> float:
    """Steps that `pairs_between` can be expected to take: rows of cells looked into, and bodies tested there."""
    reach = seekers.reach + others.reach
    rows = cells_covered(reach, others.scale_x, others.last_x) * cells_covered(reach, others.scale_y, others.last_y)
    bodies = cells_covered(reach, others.scale_z, others.last_z) * (others.end - others.begin) / others.cells
    return float((seekers.end - seekers.begin) * (4.0 + rows * (1.0 + bodies)))  # 4: to find the first cell


@inner
def compare(slot: int, begin: int, end: int, square: float, cells: Cells, keys: Keys, close: int) -> int:
    """Put the body in a slot to the test with a run of others, of which those with centres farther apart than the root
    of `square`, m^2, are passed over. Returns how many close pairs are found by now."""
    slots, columns = cells.slots, cells.columns
    x, y, z, radius = columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot]
    for other in range(begin, end):
        dx, dy, dz = x - columns[0, other], y - columns[1, other], z - columns[2, other]
        near = dx * dx + dy * dy + dz * dz <= square
        if near and touching(dx, dy, dz, radius + columns[3, other]):
            if close < len(keys):
                i, j = slots[slot, 1], slots[other, 1]
                keys[close] = min(i, j) << 32 | max(i, j)
            close += 1
    return close


class Overlapped(NamedTuple):
    """Cells of its own level that a body's bounding cube overlaps: the most of any body, and the sum over all."""

    most: int
    total: int


@kernel
def count_overlapped(levels: Levels, columns: Floats) -> Overlapped:
    """How many cells the bodies overlap, as they were last sorted."""
    most, total = 0, 0
    for index in range(len(levels)):
        level = levels[index]
        for slot in range(level.begin, level.end):
            block = block_around(level, columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot])
            overlapped = (block.x1 - block.x0 + 1) * (block.y1 - block.y0 + 1) * (block.z1 - block.z0 + 1)
            most = max(most, overlapped)
            total += overlapped
    return Overlapped(most, total)
