"""What the scheduler knows, as arrays: one row a sphere, one scheduled event a sphere, the cells, the tallies.

The named tuples are handed to the compiled loop whole; everything in them changes in place.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Indices = NDArray[np.uint32]  # unsigned: the compiled code then need not ask whether an index counts from the end
Longs = NDArray[np.int64]
Bytes = NDArray[np.int8]

# Columns of a sphere's row: 64 bytes, one cache line. Position holds at the sphere's own time.
X, TIME, VX, RADIUS = 0, 3, 4, 7
ROW = 8

# A sphere's book: 64 bytes more, with what the scheduler knows of it. Three numbers, and ten marks (as 32-bit
# integers).
PAIR_TIME, TOUCHED, MASS = 0, 1, 2
HITS, PARTNER, PARTNER_HITS, KIND, LABEL, BURST, PLACE, GRID = 6, 7, 8, 9, 10, 11, 12, 15

# What a sphere's scheduled event is. Walls and crossings add 2 * axis + (1 if moving up the axis). A search is for the
# contact of a shape inside its bounding sphere.
SEARCH, FRESH, PAIR, WALL, CROSSING, RENEWAL, NOTHING = -1, 0, 1, 2, 8, 14, 15

# Where neighbours come from, and what a touch does.
CELLS, LISTS = 0, 1
NONE, REFLECT, ELASTIC = 0, 1, 2

# Entries of `Tally.counts`.
PAIR_HITS, BOX_HITS, PREDICTIONS, PAIR_TESTS, CROSSINGS, RENEWALS, GUARDED, STALLED, STALE, POPS, RECORDED = range(11)
MARK_I, MARK_J, REBASINGS, NARROW_TESTS, BOX_TESTS, ADVANCES = range(11, 17)
COUNTS = 17
# Entries of `Tally.sums`; each has its compensation SUMS places further on.
PAIR_VIRIAL, WALL_VIRIAL, LOST_ENERGY, LOST_ENERGY_TIME, FACES = 0, 1, 2, 3, 4
SUMS = 10
# Entries of `Tally.clock`: absolute time = (EPOCH + EPOCH_REST) + NOW; MARK is the time of the last onset.
EPOCH, EPOCH_REST, NOW, MARK = range(4)

# Places of a neighbour list, one for its length; a crowd larger than this goes back to cells. Most lists fill one
# cache line.
CAPACITY = 32


class Spheres(NamedTuple):
    """n spheres: flight, book and marks.

    rows : (n, 8) x, y, z, own time, vx, vy, vz, radius
    book : (n, 8) time of the earliest pair candidate (it outlives crossings), time of the last hit, mass, and marks
    marks : (n, 16) the book's memory as integers: hits (how often the velocity changed: an event made for another
        count is stale), the candidate, its hits when it was looked at, kind of the scheduled event, label (the
        caller's numbering, which breaks ties), hits in no time, cell ix, iy, iz, grid
    contacts : (n,) time of the last pair hit
    """

    rows: Floats
    book: Floats
    marks: Ints
    contacts: Floats


class Agenda(NamedTuple):
    """The event each sphere holds, under a tournament tree: leaf n_leaves + k is sphere k, node 1 the next event."""

    times: Floats  # (2 n_leaves,) never negative, so that their bits, read as integers, are in the same order
    order: Longs  # (2 n_leaves,) those bits, in the same memory: the tree climbs 1.5 times as fast on integers
    winners: Ints  # (2 n_leaves,)


class Cells(NamedTuple):
    """Grids, coarsest first, one a size class; a sphere stands in the grid of its class only."""

    heads: Indices  # (cells of all grids,) first sphere, n = empty
    following: Indices  # (n + 1,) the next sphere in the same cell
    shapes: Longs  # (grids, 4): cells along x, y, z; place of the first in heads
    frames: Floats  # (grids, 8): origin, cell sides, largest radius, margin
    renewals: Floats  # (n,) when a sphere has flown its margin and must look at finer grids again


class Lists(NamedTuple):
    """Neighbours within touching distance + skin, of spheres that moved at most skin / 2 from their anchors."""

    anchors: Floats  # (n, 3)
    members: Indices  # (n, CAPACITY): how many, then who


class Rules(NamedTuple):
    """What stays the same during a run."""

    half_box: Floats  # (3,)
    method: int
    response: int
    restitution: float
    skin: float
    contact_time: float  # s: a pair hit this soon after another is answered elastically
    blink: float  # s: pair hits of a sphere that follow each other this soon come in no time
    pause: float  # s: what a stalled sphere waits
    burst: int  # hits in no time that a sphere may have
    touching: float  # m: gaps below this are contact (response none)
    span: int  # events from one re-basing of time to the next
    crowded: bool  # too many for the cache
    depth: int  # levels of the tournament tree
    tidying: int  # re-basings from one re-ordering of memory to the next, 0 = never


class Tally(NamedTuple):
    """Counters (COUNTS,), compensated sums (20,) and the clock (4,)."""

    counts: Longs
    sums: Floats
    clock: Floats


class Journal(NamedTuple):
    """A chunk of recorded events; no room means no recording."""

    times: Floats
    kinds: Bytes
    first: Ints
    second: Ints
    walls: Bytes


class Scratch(NamedTuple):
    """Working space of one search: candidates (n + 1,), and their lanes."""

    candidates: Indices
    lanes: Floats


class World(NamedTuple):
    """All of it."""

    spheres: Spheres
    agenda: Agenda
    cells: Cells
    lists: Lists
    rules: Rules
    tally: Tally
    journal: Journal
    scratch: Scratch


def aligned_rows(count: int, row: int = ROW) -> Floats:
    """(count, row) zeros that start on a cache line."""
    raw = np.zeros(count * row + ROW)
    skip = (-raw.ctypes.data // 8) % ROW
    return raw[skip : skip + count * row].reshape(count, row)
