"""Windows: from when to when two bodies can touch, as their bounding spheres tell, and what is known of them so far.

A window is held by one of the two bodies, in a list; it is valid while the other's count of hits is the one noted in
it (the holder drops all its windows when its own velocity changes). What a window waits for is first a search, due when
the spheres meet, and then the hit that the search has found. Most windows are closed again before they are due, and
cost no search.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from harness.kernel import step
from harness.motion.predictive.state import HITS, LABEL, Bytes, Floats, Ints, Longs

# What a window, or a body's way to a wall, waits for: a search for the contact of bodies that are apart; the same for
# bodies whose spheres overlap when they are first looked at, so that they may be touching; a search for the end of a
# contact; that end; or the hit that a search has found.
APART, UNSURE, TOUCHING, PARTING, DUE = range(5)

# Columns of `marks`.
OTHER, OTHER_HITS, PHASE, NEXT = range(4)
# Entries of `free`: the first of the free windows, and how many there are.
FIRST, COUNT = 0, 1
# Warm starts kept for a search: four of the hulls' and four of the surfaces'.
SEEDS = 8
NOBODY = -1


class Windows(NamedTuple):
    """Lists of windows, one a body, in a common pool; and each body's ways to the three walls ahead of it.

    Attributes
    ----------
    heads : (n,) first window of each body
    held : (n,) the window that a body's scheduled event is about; -1 - axis for a way to a wall
    times : (m,) s, when the search or the hit is due
    ends : (m,) s, after which the pair is silent
    marks : (m, 4) int32: the other body, its hits, the phase, the next window
    seeds : (m, SEEDS) where the last search of the pair ended
    free : (2,) the first free window, and how many
    wall_times : (n, 3) s, when a search or a hit is due at the wall ahead along an axis
    wall_phases : (n, 3)
    """

    heads: Ints
    held: Ints
    times: Floats
    ends: Floats
    marks: Ints
    seeds: Longs
    free: Longs
    wall_times: Floats
    wall_phases: Bytes


def windows(bodies: int, room: int) -> Windows:
    """No windows yet, room for so many."""
    marks = np.zeros((room, 4), dtype=np.int32)
    marks[:, NEXT] = np.append(np.arange(1, room), NOBODY)
    return Windows(
        heads=np.full(bodies, NOBODY, dtype=np.int32),
        held=np.full(bodies, NOBODY, dtype=np.int32),
        times=np.zeros(room),
        ends=np.zeros(room),
        marks=marks,
        seeds=np.full((room, SEEDS), -1, dtype=np.int64),
        free=np.array([0, room]),
        wall_times=np.full((bodies, 3), np.inf),
        wall_phases=np.zeros((bodies, 3), dtype=np.int8),
    )


def enlarged(full: Windows) -> Windows:
    """The same windows and as many free ones again."""
    room = len(full.times)
    larger = windows(len(full.heads), 2 * room)
    for name in ("times", "ends", "marks", "seeds"):
        getattr(larger, name)[:room] = getattr(full, name)
    larger.marks[-1, NEXT] = full.free[FIRST]
    larger.free[:] = room, full.free[COUNT] + room
    return larger._replace(heads=full.heads, held=full.held, wall_times=full.wall_times, wall_phases=full.wall_phases)


@step
def find(windows: Windows, first: int, p: int) -> int:
    """The window on body p in a list that begins with `first`; -1 if there is none."""
    w = first
    while w >= 0 and windows.marks[w, OTHER] != p:
        w = windows.marks[w, NEXT]
    return w


@step
def holds(windows: Windows, body_marks: Ints, w: int) -> bool:
    """Whether a window is there and stands: the other body still flies as it did."""
    return w >= 0 and body_marks[windows.marks[w, OTHER], HITS] == windows.marks[w, OTHER_HITS]


@step
def add(windows: Windows, body_marks: Ints, k: int, p: int, time: float, end: float, phase: int) -> int:
    """A new window of body k on body p."""
    w = int(windows.free[FIRST])
    windows.free[FIRST] = windows.marks[w, NEXT]
    windows.free[COUNT] -= 1
    windows.times[w] = time
    windows.ends[w] = end
    windows.marks[w, OTHER] = p
    windows.marks[w, OTHER_HITS] = body_marks[p, HITS]
    windows.marks[w, PHASE] = phase
    windows.marks[w, NEXT] = windows.heads[k]
    windows.heads[k] = w
    for seed in range(SEEDS):
        windows.seeds[w, seed] = -1
    return w


@step
def remove(windows: Windows, k: int, w: int) -> None:
    """Body k closes one of its windows."""
    following = windows.marks[w, NEXT]
    if windows.heads[k] == w:
        windows.heads[k] = following
    else:
        before = windows.heads[k]
        while windows.marks[before, NEXT] != w:
            before = windows.marks[before, NEXT]
        windows.marks[before, NEXT] = following
    windows.marks[w, NEXT] = windows.free[FIRST]
    windows.free[FIRST] = w
    windows.free[COUNT] += 1


@step
def close_all(windows: Windows, first: int) -> None:
    """Close the windows of a list."""
    w = first
    while w >= 0:
        following = windows.marks[w, NEXT]
        windows.marks[w, NEXT] = windows.free[FIRST]
        windows.free[FIRST] = w
        windows.free[COUNT] += 1
        w = following


@step
def next_due(windows: Windows, body_marks: Ints, k: int) -> tuple[float, int]:
    """When body k's next window is due, and which; ties go to searches, and then to the lower label.

    (inf, -1) if it has none.
    """
    best = inf
    which = -1
    w = windows.heads[k]
    while w >= 0:
        time = windows.times[w]
        if time < best or (time == best and which >= 0 and sooner(windows, body_marks, w, which)):
            best = time
            which = w
        w = windows.marks[w, NEXT]
    return best, which


@step
def sooner(windows: Windows, body_marks: Ints, w: int, than: int) -> bool:
    """Whether a window comes before another of the same body and time."""
    due, than_due = windows.marks[w, PHASE] == DUE, windows.marks[than, PHASE] == DUE
    if due != than_due:
        return bool(than_due)
    label, than_label = body_marks[windows.marks[w, OTHER], LABEL], body_marks[windows.marks[than, OTHER], LABEL]
    return bool(label < than_label)


@step
def shift(windows: Windows, base: float) -> None:
    """Count all times from another base."""
    for k in range(windows.heads.size):
        w = windows.heads[k]
        while w >= 0:
            windows.times[w] -= base
            windows.ends[w] -= base
            w = windows.marks[w, NEXT]
        for axis in range(3):
            windows.wall_times[k, axis] -= base
