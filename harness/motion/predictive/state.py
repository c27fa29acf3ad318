"""The state of a run, as arrays of records: a motion and a scheduled event a sphere, the queue, the cells, the totals.

The named tuples are handed to the compiled loop whole; everything in them changes in place.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats

Ints = NDArray[np.int32]
Indices = NDArray[np.uint32]  # unsigned: the compiled code then need not ask whether an index counts from the end
Longs = NDArray[np.int64]
Records = Any  # an array of one of the types below; mypy knows no fields
Record = Any  # one of its elements

NOBODY = -1  # in place of a body, or of a window
NEVER = int(np.array(np.inf).view(np.int64))  # the bits of the time of what never happens

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

# What else the event loop knows of a sphere: 64 bytes more.
SCHEDULE = np.dtype(
    [
        ("pair_time", np.float64),  # s, of the earliest pair candidate; it outlives crossings
        ("last_hit", np.float64),  # s
        ("mass", np.float64),  # kg
        ("hits", np.int32),  # how often the velocity changed: a window made for another count is stale
        ("changed", np.int32),  # at which event since the re-basing the velocity changed last, 0: before it
        ("partner", np.int32),  # the pair candidate, -1: none
        ("predicted", np.int32),  # at which event it was; stale if the partner changed later. 0, -1: before, and stale
        ("label", np.int32),  # the caller's numbering, which breaks ties
        ("burst_hits", np.int32),  # of the present collision burst
        ("cell", np.int32, 3),  # along x, y, z
        ("size_class", np.int16),
        ("kind", np.int8),  # of the scheduled event, an `Event`
        ("face", np.int8),  # that it is about, of the box or of the cell: x-, x+, y-, y+, z-, z+
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
        ("margin", np.float64),  # m, how far a sphere flies before it is registered anew at the cells of finer grids
    ],
    align=True,
)

# The larger spheres near a cell, of coarser grids: half a cache line. More than these are not registered but counted.
LARGER_CAPACITY = 7
LARGER = np.dtype([("count", np.uint32), ("who", np.uint32, LARGER_CAPACITY)], align=True)

# Where a sphere was registered at the cells of finer grids, and those cells, if there is room for them.
ANCHOR = np.dtype(
    [
        ("position", np.float64, 3),  # m
        ("first", np.int32),  # place in `Cells.registered_at` of the first cell, -1: there is no room
        ("count", np.int32),  # of cells
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
            "recorded",  # events in the log
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

# A sphere's last pair hit, s, and how many before it came within the contact time of each other.
CONTACT = np.dtype([("last", np.float64), ("row", np.int64)], align=True)

# The onset of touching that was recorded last (response none).
ONSET = np.dtype([("time", np.float64), ("i", np.int64), ("j", np.int64)], align=True)

# A recorded event: kind is Event.PAIR or Event.WALL, j is -1 at a wall, wall is -1 between a pair.
EVENT = np.dtype([("time", "f8"), ("kind", "i1"), ("i", "i4"), ("j", "i4"), ("wall", "i1")])

# The state of the one or two spheres of a recorded event, copied as it is: a place is that of the sphere's own time.
EVENT_STATE = np.dtype(
    [
        ("now", np.float64),  # s, of the event
        ("time", np.float64, 2),  # s, of the places
        ("position", np.float64, (2, 3)),  # m
        ("before", np.float64, (2, 3)),  # m/s
        ("after", np.float64, (2, 3)),  # m/s
    ],
    align=True,
)

# Candidates are solved four at a time, and their times stand in so many lanes until the next.
FOUR, LANES = 4, 64
CANDIDATES = np.dtype(
    [
        ("due", np.float64, LANES),  # s, when it touches each
        ("earliest", np.float64),  # s, of these
        ("tied", np.int64),  # whether some may be due at one time, 0: none is
    ],
    align=True,
)

# The neighbours of a sphere, or who is anchored in a cell: most fill one cache line, and none more than two.
CAPACITY = 31
ROSTER = np.dtype([("count", np.uint32), ("who", np.uint32, CAPACITY)], align=True)


class Spheres(NamedTuple):
    """n spheres.

    motions : (n,) of MOTION
    schedule : (n,) of SCHEDULE
    contacts : (n,) of CONTACT
    """

    motions: Records
    schedule: Records
    contacts: Records


class EventQueue(NamedTuple):
    """A tournament tree over the events of the spheres: leaf n_leaves + k is sphere k's, node 1 the next of all."""

    times: Floats  # (2 n_leaves,) never negative, so that their bits, read as integers, are in the same order
    time_bits: Longs  # (2 n_leaves,) those bits, in the same memory: the tree climbs 1.5 times as fast on integers
    winners: Ints  # (2 n_leaves,)


class Cells(NamedTuple):
    """Grids, coarsest first, one a size class; a sphere stands in the grid of its class only."""

    heads: Indices  # (cells of all grids,) first sphere, n = empty
    following: Indices  # (n + 1,) the next sphere in the same cell
    grids: Records  # (grids,) of GRID
    larger: Records  # (cells of all grids,) of LARGER, the spheres of coarser grids; none of a single grid
    anchors: Records  # (n,) of ANCHOR; none of a single grid
    registered_at: Indices  # cells at which spheres are registered
    renewals: Floats  # (n,) s, when a sphere is its margin away from its anchor and must be registered anew


class Lists(NamedTuple):
    """Neighbours within touching distance + skin, of spheres that moved at most skin / 2 from their anchors."""

    anchors: Floats  # (n, 4) m, x, y, z and the radius: one line of the cache tells who is near
    members: Records  # (n,) of ROSTER
    cells: Records  # (cells,) of ROSTER, who is anchored in each


class Ignored(NamedTuple):
    """Pairs that are never asked about, by label; each stands here twice. Empty arrays if there are none."""

    first: Longs  # (n + 1,) place in `others` of the first partner that each sphere ignores
    others: Longs  # (2 pairs,) those partners, in ascending order for each sphere


class Rules(NamedTuple):
    """What stays the same during a run."""

    half_box: Floats  # (3,) m
    neighbours: int  # of `NeighbourSearch`; members of it would have numba look at the whole world anew at every call
    response: int  # of `ResponseCode`
    restitution: float
    skin: float  # m: how much farther than touching neighbours of a list may be
    contact_time: float  # s: pair hits that follow each other faster than this may be one lasting contact
    lasting: int  # from so many of them on they are, and are answered elastically
    burst_window: float  # s: a pair hit of a sphere this soon after another belongs to one collision burst
    cooldown: float  # s: what a sphere waits before a hit beyond the limit
    burst_limit: int  # hits of one burst that a sphere may have
    touching: float  # m: gaps below this are contact (response none)
    events_per_base: int  # from one re-basing of time to the next
    depth: int  # levels of the tournament tree
    bases_per_order: int  # re-basings of time from one re-ordering of memory to the next, 0 = never
    prefetching: bool  # more than the next sphere's records, as the spheres are too many for the cache


class Totals(NamedTuple):
    """What has happened so far. All but the wall impulses have one record."""

    counts: Records  # (1,) of COUNTS
    sums: Records  # (1,) of SUMS
    wall_impulses: Records  # (6,) of SUM, kg m/s, given to x-, x+, y-, y+, z-, z+
    clock: Records  # (1,) of CLOCK
    onset: Records  # (1,) of ONSET


class Scratch(NamedTuple):
    """Working space of one search."""

    found: Indices  # (n + 2,) candidates
    lanes: Records  # (1,) of CANDIDATES


class World(NamedTuple):
    """All of it."""

    spheres: Spheres
    queue: EventQueue
    cells: Cells
    lists: Lists
    ignored: Ignored
    rules: Rules
    totals: Totals
    log: Records  # a chunk of recorded EVENTs; no room means no recording
    states: Records  # the EVENT_STATE of each, or no room: then they are not kept
    scratch: Scratch
