"""Windows: from when to when two bodies can touch, as their bounding spheres tell, and what is known of them so far.

A window is held by one of the two bodies, in a list; it is valid while the other's count of hits is the one noted in
it (the holder drops all its windows when its own velocity changes). A window waits first for a search, due when the
spheres meet, and then for the hit that the search has found. Most windows are closed again before they are due, and
cost no search.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from harness.kernel import step
from harness.motion.predictive.codes import Phase
from harness.motion.predictive.state import NOBODY, Ints, Record, Records

WINDOW = np.dtype(
    [
        ("time", np.float64),  # s, when the search or the hit is due
        ("end", np.float64),  # s, after which no contact of the pair counts
        ("other", np.int32),  # the other body
        ("other_hits", np.int32),  # its hits when the window was opened
        ("phase", np.int32),  # a `Phase`
        ("next", np.int32),  # the next window of the same body, or the next free one
    ],
    align=True,
)

# Where the last search of a pair ended, for the next one to start from; -1: there was none.
WARM_START = np.dtype([("hulls", np.int64, 4), ("surfaces", np.int64, 2)], align=True)

# A body and the wall ahead of it along an axis.
WALL_WINDOW = np.dtype(
    [
        ("time", np.float64),  # s, when the search or the hit is due
        ("phase", np.int64),  # a `Phase`
    ],
    align=True,
)

# The windows that are not in use, as a list.
FREE = np.dtype([("first", np.int64), ("count", np.int64)], align=True)


class Windows(NamedTuple):
    """Lists of windows, one a body, in a common pool; and for each body and axis, one on the wall ahead.

    Attributes
    ----------
    heads : (n,) first window of each body
    held : (n,) the window that a body's scheduled event is about; -1 - axis for a wall
    pool : (m,) of WINDOW
    warm_starts : (m,) of WARM_START, one a window
    free : (1,) of FREE
    walls : (n, 3) of WALL_WINDOW
    """

    heads: Ints
    held: Ints
    pool: Records
    warm_starts: Records
    free: Records
    walls: Records


def empty_windows(bodies: int, capacity: int) -> Windows:
    """No windows yet, memory for so many."""
    pool = np.zeros(capacity, dtype=WINDOW)
    pool["next"] = np.append(np.arange(1, capacity), NOBODY)
    warm_starts = np.zeros(capacity, dtype=WARM_START)
    warm_starts["hulls"], warm_starts["surfaces"] = -1, -1
    free = np.zeros(1, dtype=FREE)
    free["count"] = capacity
    walls = np.zeros((bodies, 3), dtype=WALL_WINDOW)
    walls["time"] = np.inf
    return Windows(
        heads=np.full(bodies, NOBODY, dtype=np.int32),
        held=np.full(bodies, NOBODY, dtype=np.int32),
        pool=pool,
        warm_starts=warm_starts,
        free=free,
        walls=walls,
    )


def enlarged(full: Windows) -> Windows:
    """The same windows and as many free ones again."""
    capacity = len(full.pool)
    larger = empty_windows(len(full.heads), 2 * capacity)
    larger.pool[:capacity] = full.pool
    larger.warm_starts[:capacity] = full.warm_starts
    larger.pool["next"][-1] = full.free["first"][0]
    larger.free["first"] = capacity
    larger.free["count"] = full.free["count"] + capacity
    return larger._replace(heads=full.heads, held=full.held, walls=full.walls)


@step
def find(windows: Windows, first: int, p: int) -> int:
    """The window on body p in a list that begins with `first`; -1 if there is none."""
    w = first
    while w >= 0 and windows.pool[w].other != p:
        w = windows.pool[w].next
    return w


@step
def valid(windows: Windows, schedule: Records, w: int) -> bool:
    """Whether a window is there and valid: the other body still flies as it did."""
    return w >= 0 and schedule[windows.pool[w].other].hits == windows.pool[w].other_hits


@step
def open_on(windows: Windows, schedule: Records, k: int, p: int) -> int:
    """A new window of body k on body p, whose times and phase the caller sets."""
    w = int(windows.free[0].first)
    new = windows.pool[w]
    windows.free[0].first = new.next
    windows.free[0].count -= 1
    new.other = p
    new.other_hits = schedule[p].hits
    new.next = windows.heads[k]
    windows.heads[k] = w
    windows.warm_starts[w].hulls[:] = -1
    windows.warm_starts[w].surfaces[:] = -1
    return w


@step
def close(windows: Windows, k: int, w: int) -> None:
    """Body k closes one of its windows."""
    pool = windows.pool
    following = pool[w].next
    if windows.heads[k] == w:
        windows.heads[k] = following
    else:
        before = windows.heads[k]
        while pool[before].next != w:
            before = pool[before].next
        pool[before].next = following
    release(windows, w)


@step
def release(windows: Windows, w: int) -> None:
    """A window that is in no list any more is free."""
    windows.pool[w].next = windows.free[0].first
    windows.free[0].first = w
    windows.free[0].count += 1


@step
def close_all(windows: Windows, first: int) -> None:
    """Close the windows of a list."""
    w = first
    while w >= 0:
        following = windows.pool[w].next
        release(windows, w)
        w = following


@step
def next_due(windows: Windows, schedule: Records, k: int) -> int:
    """Body k's window that is due next, -1 if it has none; ties go to searches, and then to the lower label."""
    best = inf
    which = -1
    w = windows.heads[k]
    while w >= 0:
        window = windows.pool[w]
        time = window.time
        if time < best or (time == best and which >= 0 and sooner(window, windows.pool[which], schedule)):
            best = time
            which = w
        w = window.next
    return which


@step
def sooner(window: Record, than: Record, schedule: Records) -> bool:
    """Whether a window comes before another of the same body and time."""
    due, than_due = window.phase == Phase.DUE, than.phase == Phase.DUE
    if due != than_due:
        return bool(than_due)
    return bool(schedule[window.other].label < schedule[than.other].label)


@step
def shift_windows(windows: Windows, base: float) -> None:
    """Count all times from another base."""
    for k in range(windows.heads.size):
        w = windows.heads[k]
        while w >= 0:
            windows.pool[w].time -= base
            windows.pool[w].end -= base
            w = windows.pool[w].next
        for axis in range(3):
            windows.walls[k, axis].time -= base
