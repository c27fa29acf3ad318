"""Cells: the kernels under both grids. Bodies are sorted by cell, and only neighbouring cells are compared.

Bodies belong to levels, the largest first. Every level has a lattice of its own over the same space, with cells at
least as large as its largest body, so that two of its bodies touch only from the same cell or from neighbouring ones.
The cells of all levels are numbered on, so that one counting sort a frame puts every body in its place. The uniform
grid has one level.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.broadphase.lanes import LANES, lanes_within, lowest_bit
from harness.broadphase.levels import SLACK, Level, Levels, block_around, cell_at, cells_covered, fit_lattices
from harness.broadphase.pairs import NEARLY, Keys, require_finite, touching
from harness.kernel import inner, kernel

Ints = NDArray[np.int32]

GATHERED = 256
"""Bodies whose places are gathered at a time. A loop that does nothing else keeps many reads of memory under way."""

RUNS = 5
"""Of three cells along z, with whose bodies one of the same level is compared: its own, and four later neighbours."""


class Cells(NamedTuple):
    """The bodies of a frame, sorted by cell. A slot is a body's place in the order by level, then cell.

    Attributes
    ----------
    members : (n,) the bodies by level, each level's as they were sorted in the last frame: those that are near each
        other in the box then are near each other in memory. Rewritten
    levels : (levels,) of LEVEL, with reach, budget, begin and end given; the rest is written every frame
    start : (sum of budgets + 1,) written: the first slot of each cell
    cell_of : (n,) written: each member's cell
    places : (n, 4) written: each member's x, y, z and radius, m
    slots : (n, 2) written: each slot's cell and body
    spheres : (n, 4) rewritten: each slot's x, y, z and radius, m
    columns : (3, n + LANES) written: each slot's x, y and z once more, m, to be compared several at once
    """

    members: Ints
    levels: Levels
    start: Ints
    cell_of: Ints
    places: Floats
    slots: Ints
    spheres: Floats
    columns: Floats


Arrays = tuple[Ints, Levels, Ints, Ints, Floats, Ints, Floats, Floats]


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
    require_finite(positions)
    cells = Cells(*bodies)
    levels = cells.levels
    fit_lattices(positions, half, levels)
    sort_by_cell(positions, cells)
    close, tests = 0, 0
    for fine in range(len(levels)):
        close, tests = pairs_within(levels[fine], cells, keys, close, tests)
        for coarse in range(fine):
            seekers, others = levels[fine], levels[coarse]
            if expected_work(others, seekers) < expected_work(seekers, others):
                seekers, others = others, seekers
            close, tests = pairs_between(seekers, others, cells, keys, close, tests)
    return close, tests


@kernel
def sort_by_cell(positions: Floats, cells: Cells) -> None:
    """Counting sort: count the bodies of each cell, sum up to each cell's end, fill each cell from its end."""
    members, levels, start, cell_of, places, slots, spheres, columns = cells
    used = levels[-1].first + levels[-1].cells
    start[: used + 1] = 0
    for index in range(len(levels)):
        level = levels[index]
        for begin in range(level.begin, level.end, GATHERED):
            end = min(begin + GATHERED, level.end)
            gather(positions, cells, begin, end)
            for member in range(begin, end):
                cell = cell_at(level, places[member, 0], places[member, 1], places[member, 2])
                cell_of[member] = cell
                start[cell] += 1
    end = 0
    for cell in range(used + 1):
        end += start[cell]
        start[cell] = end
    for member in range(len(members) - 1, -1, -1):
        cell = cell_of[member]
        slot = start[cell] - 1
        start[cell] = slot
        slots[slot, 0], slots[slot, 1] = cell, members[member]
        for axis in range(3):
            columns[axis, slot] = places[member, axis]
        for number in range(4):
            spheres[slot, number] = places[member, number]
    for slot in range(len(members)):
        members[slot] = slots[slot, 1]


@kernel
def gather(positions: Floats, cells: Cells, begin: int, end: int) -> None:
    """Write the places of some members, whose radii stand where they were sorted last."""
    members, places, spheres = cells.members, cells.places, cells.spheres
    for member in range(begin, end):
        i = members[member]
        for axis in range(3):
            places[member, axis] = positions[i, axis]
        places[member, 3] = spheres[member, 3]


@kernel
def pairs_within(level: Level, cells: Cells, keys: Keys, close: int, tests: int) -> Found:
    """Each body with those after it in its own cell, and with the later half of the neighbouring cells.

    The first bodies of all runs are compared before any pair is noted, as whether one is near cannot be foreseen, and a
    branch for each run would be mispredicted.

    Parameters and answer: `close` pairs and `tests` so far, and with those of this level.
    """
    start, slots, spheres, columns = cells.start, cells.slots, cells.spheres, cells.columns
    row, plane = level.row, level.plane
    begins, ends = np.empty(RUNS, np.int64), np.empty(RUNS, np.int64)
    for slot in range(level.begin, level.end):
        cell = slots[slot, 0]
        x, y, z = spheres[slot, 0], spheres[slot, 1], spheres[slot, 2]
        square = NEARLY * (spheres[slot, 3] + level.reach) ** 2
        near, longest = 0, 0
        for run in range(RUNS):
            middle = cell + (row if run == 1 else plane + (run - 3) * row)
            begin, end = start[middle - 1], start[middle + 2]
            if run == 0:
                begin = slot + 1
                end = max(begin, start[cell + 2])
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
            close = compare(slot, other, other + 1, slots, spheres, keys, close)
        if longest > LANES:
            for run in range(RUNS):
                close = compare(slot, begins[run] + LANES, ends[run], slots, spheres, keys, close)
    return Found(close, tests)


@kernel
def pairs_between(seekers: Level, others: Level, cells: Cells, keys: Keys, close: int, tests: int) -> Found:
    """Each body of one level with the bodies of the other in all cells where their centres can be.

    Either level may seek. Many small bodies each look into a few cells of the coarse lattice, but a few large ones do
    less work if they go through the fine cells that they cover. `close` and `tests` are as for `pairs_within`.
    """
    start, slots, spheres = cells.start, cells.slots, cells.spheres
    for slot in range(seekers.begin, seekers.end):
        reach = (spheres[slot, 3] + others.reach) * (1.0 + SLACK)
        block = block_around(others, spheres[slot, 0], spheres[slot, 1], spheres[slot, 2], reach)
        first, last = others.first + block.x0 * others.plane, others.first + block.x1 * others.plane
        for plane in range(first, last + 1, others.plane):
            for row in range(plane + block.y0 * others.row, plane + block.y1 * others.row + 1, others.row):
                begin, end = start[row + block.z0], start[row + block.z1 + 1]
                close = compare(slot, begin, end, slots, spheres, keys, close)
                tests += end - begin
    return Found(close, tests)


@kernel
def expected_work(seekers: Level, others: Level) -> float:
    """Steps that `pairs_between` can be expected to take: rows of cells looked into, and bodies tested there."""
    reach = seekers.reach + others.reach
    rows = cells_covered(reach, others.scale_x, others.last_x) * cells_covered(reach, others.scale_y, others.last_y)
    bodies = cells_covered(reach, others.scale_z, others.last_z) * (others.end - others.begin) / others.cells
    return float((seekers.end - seekers.begin) * (4.0 + rows * (1.0 + bodies)))  # 4: to find the first cell


@inner
def compare(slot: int, begin: int, end: int, slots: Ints, spheres: Floats, keys: Keys, close: int) -> int:
    """Put the body in a slot to the test with a run of others. Returns how many close pairs are found by now."""
    x, y, z, radius = spheres[slot, 0], spheres[slot, 1], spheres[slot, 2], spheres[slot, 3]
    for other in range(begin, end):
        dx, dy, dz = x - spheres[other, 0], y - spheres[other, 1], z - spheres[other, 2]
        if touching(dx, dy, dz, radius + spheres[other, 3]):
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
def count_overlapped(levels: Levels, spheres: Floats) -> Overlapped:
    """How many cells the bodies overlap, as they were last sorted."""
    most, total = 0, 0
    for index in range(len(levels)):
        level = levels[index]
        for slot in range(level.begin, level.end):
            block = block_around(level, spheres[slot, 0], spheres[slot, 1], spheres[slot, 2], spheres[slot, 3])
            overlapped = (block.x1 - block.x0 + 1) * (block.y1 - block.y0 + 1) * (block.z1 - block.z0 + 1)
            most = max(most, overlapped)
            total += overlapped
    return Overlapped(most, total)
