"""When two motions that began alike diverge: the first event of any body that differs.

Events of different bodies have no order among them: one frame shows several at once, and not which came
first. So each body's own history is compared, the partners and walls that it meets one after another. Walls that a body
meets one right after another on different axes may change places: mirroring x and then y is mirroring y and then x.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel
from harness.reference.events import Events


def first_divergence(bodies: int, one: Events, other: Events) -> float:
    """When the first event happens, in either motion, that has no counterpart in the other, s; inf if there is none.

    Parameters
    ----------
    bodies : how many there are
    one, other : the events of both motions

    >>> def hits_of_body_0(*partners):
    ...     pairs = np.array([[0, partner] for partner in partners])
    ...     return Events(np.arange(1.0, len(pairs) + 1), pairs, np.full(len(pairs), -1))
    >>> first_divergence(4, hits_of_body_0(1, 2, 1), hits_of_body_0(1, 3, 1))
    2.0
    """
    return float(_first_difference(_histories(bodies, one), _histories(bodies, other)))


class _Histories(NamedTuple):
    """Of each body in turn, whom it meets (-1 - wall for walls) and when (s); `starts` has where each body's begin."""

    starts: Ints
    met: Ints
    when: Floats


def _histories(bodies: int, events: Events) -> _Histories:
    times, pairs, walls = events
    numbers = np.arange(len(times))
    both = walls < 0
    who = np.concatenate([pairs[:, 0], pairs[both, 1]])
    met = np.concatenate([np.where(both, pairs[:, 1], -1 - walls), pairs[both, 0]])
    event = np.concatenate([numbers, numbers[both]])
    order = np.lexsort((event, who))
    who, met, when = who[order], met[order], times[event[order]]
    starts = np.searchsorted(who, np.arange(bodies + 1)).astype(np.int64)
    # runs of walls are sorted by axis, each axis keeping its order
    is_wall = met < 0
    run = np.cumsum(~is_wall | np.concatenate([[True], ~is_wall[:-1]])) if len(met) else np.empty(0, np.int64)
    axis = np.where(is_wall, (-1 - met) // 2, 0)
    order = np.lexsort((axis, run, who))
    return _Histories(starts, met[order].astype(np.int64), when[order])


@kernel
def _first_difference(one: _Histories, other: _Histories) -> float:
    first = inf
    for body in range(len(one.starts) - 1):
        a, a_end = one.starts[body], one.starts[body + 1]
        b, b_end = other.starts[body], other.starts[body + 1]
        while a < a_end and b < b_end and one.met[a] == other.met[b]:
            a += 1
            b += 1
        if a < a_end:
            first = min(first, one.when[a])
        if b < b_end:
            first = min(first, other.when[b])
    return first
