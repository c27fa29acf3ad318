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
from harness.broadphase.cell_order import Cells, Indices, Rows, sort_by_cell
from harness.broadphase.lanes import LANES, lanes_touching, lanes_within, lowest_bit
from harness.broadphase.level_choice import expected_work, fit_lattices
from harness.broadphase.levels import SLACK, Level, Levels, block_around, cells_of, lattice_of
from harness.broadphase.pairs import NEARLY, Keys, touching
from harness.kernel import kernel, strict_step

RUNS = 5
"""Of three cells along z, with whose bodies one of the same level is compared: its own, and four later neighbours."""

FIRST = 2 * LANES
"""Bodies of a run with a bit each in the one integer of all runs: those that are compared before a pair is written."""

CROWDED = 2.0
"""Bodies in a run of three cells, on average, from which on `FIRST` of each are compared at once, and not only `LANES`.

A frame of 10^4 bodies of sizes spread evenly over 10:1 takes a fifth less with that; with fewer it is work in vain."""

Arrays = tuple[Indices, Floats, Levels, Indices, Indices, Rows, Indices, Floats]

RunBounds = NDArray[np.int64]  # (2, RUNS) the first slot of each run, and the one after its last


class Found(NamedTuple):
    """How many pairs are close, and how many were tested."""

    close: int
    tests: int


class Seeker(NamedTuple):
    """A body that is compared with runs of others: its slot, its sphere, m, and the square of the largest distance that
    the centre of one that it touches can have, m^2."""

    slot: int
    x: float
    y: float
    z: float
    radius: float
    square: float


class Others(NamedTuple):
    """What is known of the bodies that are compared with one. The compiler makes a loop for each answer.

    Attributes
    ----------
    one_size : whether all have the same radius; then the largest distance is the same for all
    crowded : whether runs of more than `LANES` are common
    """

    one_size: bool
    crowded: bool


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
    levels, runs = cells.levels, np.empty((2, RUNS), np.int64)
    found = Found(0, 0)
    for fine in range(len(levels)):
        level = levels[fine]
        begin, end = part_of(level, part, parts)
        if one_size(level):
            found = pairs_within(level, begin, end, Others(True, False), cells, runs, keys, found)
        else:
            found = pairs_within(level, begin, end, Others(False, crowded(level)), cells, runs, keys, found)
        for coarse in range(fine):
            seekers, others = levels[fine], levels[coarse]
            if seekers.begin == seekers.end or others.begin == others.end:  # the class shares another level
                continue
            if expected_work(others, seekers) < expected_work(seekers, others):
                seekers, others = others, seekers
            begin, end = part_of(seekers, part, parts)
            if one_size(others):
                found = pairs_between(others, begin, end, Others(True, False), cells, runs, keys, found)
            else:
                known = Others(False, crowded(others))
                found = pairs_between(others, begin, end, known, cells, runs, keys, found)
    return found.close, found.tests


@kernel
def part_of(level: Level, part: int, parts: int) -> tuple[int, int]:
    """The slots where a part of the bodies of a level begins and ends."""
    count = level.end - level.begin
    return level.begin + count * part // parts, level.begin + count * (part + 1) // parts


@strict_step
def one_size(level: Level) -> bool:
    """Whether all bodies of a level have the same radius."""
    return bool(level.least == level.reach)


@strict_step
def crowded(level: Level) -> bool:
    """Whether runs of three cells of a level often have more than `LANES` bodies."""
    return bool(3.0 * (level.end - level.begin) > CROWDED * cells_of(level))


@strict_step
def pairs_within(
    level: Level, first: int, last: int, others: Others, cells: Cells, runs: RunBounds, keys: Keys, found: Found
) -> Found:
    """Each body with those after it in its own cell, and with the later half of the neighbouring cells.

    The first bodies of all runs are compared before any pair is written: whether one is near cannot be foreseen, and a
    branch for each run would be mispredicted. Cells are unsigned as indices, or numba would ask of each whether it
    counts from the end, which takes a quarter of the time.

    Parameters
    ----------
    level : of the bodies
    first, last : their slots, from the first until the last
    others : what is known of the bodies of the level
    cells, keys : as for `close_pairs`
    runs : written
    found : so far; the answer counts those of this level as well
    """
    start, slots, columns = cells.start, cells.slots, cells.columns
    row, plane, most = level.row, level.plane, level.reach
    close, tests = found.close, found.tests
    for slot in range(first, last):
        cell = slots[slot, 0]
        x, y, z, radius = columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot]
        seeker = Seeker(slot, x, y, z, radius, NEARLY * (radius + most) ** 2)
        near, longest = 0, 0
        for run in range(RUNS):
            middle = cell + (run * row if run < 2 else plane + (run - 3) * row)
            begin, end = slot + 1, start[np.uintp(middle + 2)]
            if run > 0:
                begin = start[np.uintp(middle - 1)]
            runs[0, run], runs[1, run] = begin, end
            near |= first_near(seeker, begin, end, others, columns) << (run * FIRST)
            longest = max(longest, end - begin)
            tests += end - begin
        close = write_pairs(seeker, near, longest, RUNS, others, cells, runs, keys, close)
    return Found(close, tests)


@strict_step
def pairs_between(
    level: Level, first: int, last: int, others: Others, cells: Cells, runs: RunBounds, keys: Keys, found: Found
) -> Found:
    """Bodies of another level with those of a level in all cells where their centres can be.

    Either level may seek. Many small bodies each look into a few cells of the coarse lattice, but a few large ones do
    less work if they go through the fine cells that they cover. The bodies that seek are those in the slots from
    `first` until `last`; the rest is as for `pairs_within`.

    Most look into four rows of cells or fewer, and then into four, of which some may count as empty: how many they are
    cannot be foreseen either.
    """
    start, columns = cells.start, cells.columns
    lattice, most = lattice_of(level), level.reach
    row, plane = lattice.row, lattice.plane
    close, tests = found.close, found.tests
    for slot in range(first, last):
        x, y, z, radius = columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot]
        reach = (radius + most) * (1.0 + SLACK)
        seeker = Seeker(slot, x, y, z, radius, NEARLY * reach * reach)
        block = block_around(lattice, x, y, z, reach)
        wide, deep, tall = block.x1 - block.x0 + 1, block.y1 - block.y0 + 1, block.z1 - block.z0 + 1
        corner = lattice.first + block.x0 * plane + block.y0 * row + block.z0
        if (wide <= 2) & (deep <= 2):
            near, longest = 0, 0
            for run in range(4):
                along_x, along_y = run // 2, run % 2
                cell = corner + (wide - 1) * along_x * plane + (deep - 1) * along_y * row
                begin, end = start[np.uintp(cell)], start[np.uintp(cell + tall)]
                if along_x >= wide or along_y >= deep:
                    end = begin
                runs[0, run], runs[1, run] = begin, end
                near |= first_near(seeker, begin, end, others, columns) << (run * FIRST)
                longest = max(longest, end - begin)
                tests += end - begin
            close = write_pairs(seeker, near, longest, 4, others, cells, runs, keys, close)
            continue
        for first_of_plane in range(corner, corner + wide * plane, plane):
            for cell in range(first_of_plane, first_of_plane + deep * row, row):
                begin, end = start[np.uintp(cell)], start[np.uintp(cell + tall)]
                runs[0, 0], runs[1, 0] = begin, end
                near = first_near(seeker, begin, end, others, columns)
                tests += end - begin
                close = write_pairs(seeker, near, end - begin, 1, others, cells, runs, keys, close)
    return Found(close, tests)


@strict_step
def write_pairs(
    seeker: Seeker,
    near: int,
    longest: int,
    count: int,
    others: Others,
    cells: Cells,
    runs: RunBounds,
    keys: Keys,
    close: int,
) -> int:
    """Put a body to the test with the first bodies of so many runs that are near, and with all that come after these.

    `longest` is the length of the longest run. Returns how many close pairs are found by now.
    """
    while near != 0:
        bit = lowest_bit(near)
        near &= near - 1
        close = write_if_touching(seeker, runs[0, bit // FIRST] + bit % FIRST, cells, keys, close)
    compared = FIRST if others.crowded else LANES
    if longest > compared:
        every = Others(others.one_size, True)
        for run in range(count):
            end = runs[1, run]
            for begin in range(runs[0, run] + compared, end, FIRST):
                near = first_near(seeker, begin, end, every, cells.columns)
                while near != 0:
                    bit = lowest_bit(near)
                    near &= near - 1
                    close = write_if_touching(seeker, begin + bit, cells, keys, close)
    return close


@strict_step
def first_near(seeker: Seeker, begin: int, end: int, others: Others, columns: Floats) -> int:
    """Which of the first bodies of a run may touch a body, a bit each: of `FIRST` in a crowd, else of `LANES`."""
    x, y, z, radius, square = seeker.x, seeker.y, seeker.z, seeker.radius, seeker.square
    if others.one_size:
        near = lanes_within(columns, begin, x, y, z, square)
        if others.crowded:
            near |= lanes_within(columns, begin + LANES, x, y, z, square) << LANES
    else:
        near = lanes_touching(columns, begin, x, y, z, radius)
        if others.crowded:
            near |= lanes_touching(columns, begin + LANES, x, y, z, radius) << LANES
    return near & ((1 << min(end - begin, FIRST)) - 1)


@strict_step
def write_if_touching(seeker: Seeker, other: int, cells: Cells, keys: Keys, close: int) -> int:
    """Write a body and the one in another slot if they touch. Returns how many close pairs are found by now."""
    slots, columns = cells.slots, cells.columns
    dx, dy, dz = seeker.x - columns[0, other], seeker.y - columns[1, other], seeker.z - columns[2, other]
    if touching(dx, dy, dz, seeker.radius + columns[3, other]):
        if close < len(keys):
            i, j = slots[seeker.slot, 1], slots[other, 1]
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
            block = block_around(
                lattice_of(level), columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot]
            )
            overlapped = (block.x1 - block.x0 + 1) * (block.y1 - block.y0 + 1) * (block.z1 - block.z0 + 1)
            most = max(most, overlapped)
            total += overlapped
    return Overlapped(most, total)
