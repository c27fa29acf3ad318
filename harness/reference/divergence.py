"""When two motions that began alike part: the first event of any body that differs.

Events of different bodies have no order among them: one frame shows several at once, and says nothing of which came
first. So each body's own history is compared, the partners and walls that it meets one after another. Walls that a body
meets one right after another on different axes may change places: mirroring x and then y is mirroring y and then x.
"""

from __future__ import annotations

from math import inf

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.kernel import kernel


def first_divergence(
    bodies: int, times: Floats, pairs: Pairs, walls: Ints, other_times: Floats, other_pairs: Pairs, other_walls: Ints
) -> float:
    """When the first event happens, in either motion, that has no counterpart in the other; inf if there is none.

    Parameters
    ----------
    bodies : how many there are
    times : (k,) float array, s, in order
    pairs : (k, 2) int array, who meets; the second is -1 where a wall is met
    walls : (k,) int array, number of the wall, -1 where two bodies meet
    other_times, other_pairs, other_walls : the same of the other motion
    """
    starts, met, when = _histories(bodies, times, pairs, walls)
    other_starts, other_met, other_when = _histories(bodies, other_times, other_pairs, other_walls)
    return float(_first_difference(starts, met, when, other_starts, other_met, other_when))


def _histories(bodies: int, times: Floats, pairs: Pairs, walls: Ints) -> tuple[Ints, Ints, Floats]:
    """Of each body in turn, whom it meets (-1 - wall for walls) and when; `starts` says where each body's begin."""
    events = np.arange(len(times))
    both = walls < 0
    who = np.concatenate([pairs[:, 0], pairs[both, 1]])
    met = np.concatenate([np.where(both, pairs[:, 1], -1 - walls), pairs[both, 0]])
    event = np.concatenate([events, events[both]])
    order = np.lexsort((event, who))
    who, met, when = who[order], met[order], times[event[order]]
    starts = np.searchsorted(who, np.arange(bodies + 1)).astype(np.int64)
    # runs of walls are sorted by axis, each axis keeping its order
    is_wall = met < 0
    run = np.cumsum(~is_wall | np.concatenate([[True], ~is_wall[:-1]])) if len(met) else np.empty(0, np.int64)
    axis = np.where(is_wall, (-1 - met) // 2, 0)
    order = np.lexsort((axis, run, who))
    return starts, met[order].astype(np.int64), when[order]


@kernel
def _first_difference(
    starts: Ints, met: Ints, when: Floats, other_starts: Ints, other_met: Ints, other_when: Floats
) -> float:
    first = inf
    for body in range(len(starts) - 1):
        a, a_end = starts[body], starts[body + 1]
        b, b_end = other_starts[body], other_starts[body + 1]
        while a < a_end and b < b_end and met[a] == other_met[b]:
            a += 1
            b += 1
        if a < a_end:
            first = min(first, when[a])
        if b < b_end:
            first = min(first, other_when[b])
    return first
