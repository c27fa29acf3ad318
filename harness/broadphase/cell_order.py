"""The order of bodies by cell: a radix sort in two passes, so that neighbours in the box are neighbours in memory.

Sorted in one pass, a million bodies would be written to places all over the memory, and most writes would wait for it.
So the first pass puts them into buckets of a few hundred cells that follow one another, few enough that the ends of
all of them stay in a processor's cache; the second sorts each bucket, which stays there as a whole. Nothing is kept
from frame to frame, so that bodies may move as they like.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats
from harness.broadphase.levels import Levels, cell_in, lattice_of
from harness.kernel import kernel, strict_step

Indices = NDArray[np.int32]

MOST_BUCKETS = 8192
"""With 1024, whose cells are eight times as many, the sort of 10^6 bodies takes half as long again."""

SMALLEST_BUCKET = 8
"""Binary logarithm of the cells of a bucket, at least."""

FEW_CELLS = 1 << 17
"""Fewer cells than these are sorted in buckets four times as large: more buckets would only be more to begin."""

Rows = NDArray[np.void]

ROW = np.dtype([*((name, np.float64) for name in ("x", "y", "z", "radius")), ("cell", np.int32), ("body", np.int32)])
"""A body in its bucket: its place and radius, m, and its cell."""


class Cells(NamedTuple):
    """The bodies of a frame, sorted by cell. A slot is a body's place in that order, the largest level first.

    Attributes
    ----------
    members : (n,) the bodies by level, those of a level by their number
    radii : (n,) of each member, m
    levels : (levels,) of LEVEL, with reach and what is of the class given; the rest is written every frame
    start : (sum of budgets + 1,) written: the first slot of each cell
    cell_of : (n,) written: each member's cell
    rows : (n,) of ROW, written: the bodies by bucket
    slots : (n, 2) written: each slot's cell and body
    columns : (4, n + room) written: each slot's x, y, z and radius, m; each by itself, to be compared several at once.
        What is compared with the last slots' neighbours beyond them is left out of every answer
    """

    members: Indices
    radii: Floats
    levels: Levels
    start: Indices
    cell_of: Indices
    rows: Rows
    slots: Indices
    columns: Floats


@kernel
def sort_by_cell(positions: Floats, cells: Cells) -> None:
    """Put the bodies into buckets by their cells, then sort each bucket."""
    used = cells.levels[-1].first + cells.levels[-1].cells
    shift = SMALLEST_BUCKET if used >= FEW_CELLS else SMALLEST_BUCKET + 2
    while used >> shift >= MOST_BUCKETS:
        shift += 1
    ends = np.zeros((used >> shift) + 1, np.int32)
    find_cells(positions, cells, ends, shift)
    fill_buckets(positions, cells, ends, shift)
    begin = 0
    for bucket in range(len(ends)):
        sort_bucket(cells, begin, ends[bucket], bucket << shift, min((bucket + 1) << shift, used + 1))
        begin = ends[bucket]


@strict_step
def find_cells(positions: Floats, cells: Cells, counts: Indices, shift: int) -> None:
    """Write each member's cell, and how many bodies each bucket of 2^shift cells has."""
    members, levels, cell_of = cells.members, cells.levels, cells.cell_of
    for index in range(len(levels)):
        level = levels[index]
        lattice = lattice_of(level)
        for member in range(level.begin, level.end):
            i = np.uintp(members[member])
            cell = cell_in(lattice, positions[i, 0], positions[i, 1], positions[i, 2])
            cell_of[member] = cell
            counts[np.uintp(cell >> shift)] += 1


@strict_step
def fill_buckets(positions: Floats, cells: Cells, ends: Indices, shift: int) -> None:
    """Write the bodies by bucket. `ends` holds how many each has, and then where each ends."""
    members, radii, cell_of, rows = cells.members, cells.radii, cells.cell_of, cells.rows
    begin = 0
    for bucket in range(len(ends)):
        count = ends[bucket]
        ends[bucket] = begin
        begin += count
    for member in range(len(members)):
        cell, i = cell_of[member], np.uintp(members[member])
        bucket = np.uintp(cell >> shift)
        row = rows[np.uintp(ends[bucket])]
        ends[bucket] += 1
        row.x, row.y, row.z = positions[i, 0], positions[i, 1], positions[i, 2]
        row.radius, row.cell, row.body = radii[member], cell, i


@strict_step
def sort_bucket(cells: Cells, begin: int, end: int, first: int, last: int) -> None:
    """Sort the bodies of a bucket, from one row up to another, into its cells, from the first up to the last.

    Each cell is filled from its end.
    """
    start, rows, slots, columns = cells.start, cells.rows, cells.slots, cells.columns
    start[first:last] = 0
    for place in range(begin, end):
        start[np.uintp(rows[place].cell)] += 1
    filled = begin
    for cell in range(first, last):
        filled += start[cell]
        start[cell] = filled
    for place in range(end - 1, begin - 1, -1):
        row = rows[place]
        cell = np.uintp(row.cell)
        slot = np.uintp(start[cell] - 1)
        start[cell] = slot
        slots[slot, 0], slots[slot, 1] = row.cell, row.body
        columns[0, slot], columns[1, slot], columns[2, slot], columns[3, slot] = row.x, row.y, row.z, row.radius
