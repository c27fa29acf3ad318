"""What the scheduler knows, as arrays of records: one motion and one scheduled event a sphere, the cells, the tallies.

The named tuples are handed to the compiled loop whole; everything in them changes in place.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Indices = NDArray[np.uint32]  # unsigned: the compiled code then need not ask whether an index counts from the end
Longs = NDArray[np.int64]
Records = Any  # an array of one of the types below; mypy knows no fields
Record = Any  # one of its elements

LINE = 64  # bytes of a cache line

# A sphere's motion: 64 bytes, one cache line.
MOTION = np.dtype(
    [
        ("position", np.float64, 3),  # m, at the sphere's own time
        ("time", np.float64),  # s
        ("velocity", np.float64, 3),  # m/s
        ("radius", np.float64),  # m
    ],
    align=True,
)

# What the scheduler knows of a sphere: 64 bytes more.
SCHEDULE = np.dtype(
    [
        ("pair_time", np.float64),  # s, of the earliest pair candidate; it outlives crossings
        ("last_hit", np.float64),  # s
        ("mass", np.float64),  # kg
        ("hits", np.int32),  # how often the velocity changed: an event made for another count is stale
        ("partner", np.int32),  # the pair candidate, -1: none
        ("partner_hits", np.int32),  # its hits when it was looked at
        ("kind", np.int32),  # of the scheduled event
        ("label", np.int32),  # the caller's numbering, which breaks ties
        ("burst", np.int32),  # hits in no time
        ("cell", np.int32, 3),  # along x, y, z
        ("size_class", np.int32),
    ],
    align=True,
)

# A grid of cells, for one size class.
GRID = np.dtype(
    [
        ("shape", np.int64, 3),  # cells along x, y, z
        ("first", np.int64),  # place of its first cell in `Cells.heads`
        ("low", np.float64, 3),  # m, where it begins
        ("side", np.float64, 3),  # m, of a cell
        ("largest", np.float64),  # m, radius
        ("margin", np.float64),  # m, how far a sphere flies before it looks at finer grids again
    ],
    align=True,
)

# How often what happened.
COUNTS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "pair_hits",
            "box_hits",
            "predictions",
            "pair_tests",
            "stale_events",
            "cell_crossings",
            "list_renewals",
            "guarded_hits",
            "stalled_events",
            "narrow_tests",
            "box_tests",
            "advancement_steps",
            "rebasings",  # of time
            "since_rebasing",  # events, searches and crossings included
            "recorded",  # events in the journal
        )
    ],
    align=True,
)

# A compensated sum.
SUM = np.dtype([("total", np.float64), ("rest", np.float64)], align=True)

# Sums over all hits.
SUMS = np.dtype(
    [
        ("pair_virial", SUM),  # kg m^2/s
        ("wall_virial", SUM),  # kg m^2/s
        ("lost_energy", SUM),  # J
        ("lost_energy_time", SUM),  # J s
    ],
    align=True,
)

# Absolute time is (epoch + epoch_rest) + now.
CLOCK = np.dtype([("epoch", np.float64), ("epoch_rest", np.float64), ("now", np.float64)], align=True)

# The onset that was noted last (response none).
ONSET = np.dtype([("time", np.float64), ("i", np.int64), ("j", np.int64)], align=True)

# A recorded event: j is -1 at a wall, wall is -1 between a pair.
EVENT = np.dtype([("time", "f8"), ("kind", "i1"), ("i", "i4"), ("j", "i4"), ("wall", "i1")])
PAIR_EVENT, WALL_EVENT = 0, 1

# Candidates solved at a time, as columns. Their number is a constant, so that the compiler sees that the columns do not
# overlap.
LANES = 64
CANDIDATES = np.dtype(
    [
        (name, np.float64, LANES)
        for name in ("gap_x", "gap_y", "gap_z", "velocity_x", "velocity_y", "velocity_z", "reach", "due")
    ],
    align=True,
)

# Who is near a sphere: a list of one cache line or, if it is long, two.
CAPACITY = 31
NEIGHBOURS = np.dtype([("count", np.uint32), ("who", np.uint32, CAPACITY)], align=True)

# What a sphere's scheduled event is. Walls and crossings add 2 * axis + (1 if moving up the axis). A search is for the
# contact of a shape inside its bounding sphere.
SEARCH, FRESH, PAIR, WALL, CROSSING, RENEWAL, NOTHING = -1, 0, 1, 2, 8, 14, 15

# Where neighbours come from, and what a touch does.
CELLS, LISTS = 0, 1
NONE, REFLECT, ELASTIC = 0, 1, 2


class Spheres(NamedTuple):
    """n spheres.

    motions : (n,) of MOTION
    schedule : (n,) of SCHEDULE
    contacts : (n,) time of the last pair hit
    """

    motions: Records
    schedule: Records
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
    grids: Records  # (grids,) of GRID
    renewals: Floats  # (n,) when a sphere has flown its margin and must look at finer grids again


class Lists(NamedTuple):
    """Neighbours within touching distance + skin, of spheres that moved at most skin / 2 from their anchors."""

    anchors: Floats  # (n, 3)
    members: Records  # (n,) of NEIGHBOURS


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
    """What has happened so far. All but the walls have one record."""

    counts: Records  # (1,) of COUNTS
    sums: Records  # (1,) of SUMS
    walls: Records  # (6,) of SUM, kg m/s: impulses given to x-, x+, y-, y+, z-, z+
    clock: Records  # (1,) of CLOCK
    onset: Records  # (1,) of ONSET


class Scratch(NamedTuple):
    """Working space of one search."""

    found: Indices  # (n + 2,) candidates
    lanes: Records  # (1,) of CANDIDATES


class World(NamedTuple):
    """All of it."""

    spheres: Spheres
    agenda: Agenda
    cells: Cells
    lists: Lists
    rules: Rules
    tally: Tally
    journal: Records  # a chunk of recorded EVENTs; no room means no recording
    scratch: Scratch


def aligned(count: int, kind: np.dtype[np.void]) -> Records:
    """(count,) zeros of a type of whole cache lines, that start on a cache line."""
    raw = np.zeros(count * kind.itemsize + LINE, dtype=np.uint8)
    skip = -raw.ctypes.data % LINE
    return raw[skip : skip + count * kind.itemsize].view(kind)
