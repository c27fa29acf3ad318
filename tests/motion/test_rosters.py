"""Rosters against Python's own lists."""

from __future__ import annotations

import numpy as np

from harness.kernel import loop
from harness.motion.predictive.memory import aligned
from harness.motion.predictive.rosters import FEW, copy, enlist, strike
from harness.motion.predictive.state import CAPACITY, ROSTER


@loop
def enlist_in(rosters, k):
    return enlist(rosters[0], k)


@loop
def strike_from(rosters, k):
    strike(rosters[0], k)


@loop
def copy_of(rosters, found, n):
    return copy(rosters[0], found, n)


def test_a_roster_is_a_list():
    """However full it is, whatever numbers it held before, and a number that equals their count."""
    rng = np.random.default_rng(7)
    rosters, expected = aligned(1, ROSTER), []
    fullest = 0
    for _ in range(3000):
        if expected and rng.random() < 0.45:
            k = int(rng.choice(expected))
            place = expected.index(k)
            expected[place] = expected[-1]
            expected.pop()
            strike_from(rosters, k)
        else:
            k = int(rng.choice([k for k in range(70) if k not in expected]))
            room = enlist_in(rosters, k)
            assert room == (len(expected) < CAPACITY)
            expected += [k] * room
        found = np.full(3 + len(expected) + FEW, 99, np.uint32)
        assert copy_of(rosters, found, 3) == 3 + len(expected)
        assert found[:3].tolist() == [99] * 3
        assert found[3 : 3 + len(expected)].tolist() == expected
        fullest = max(fullest, len(expected))
    assert fullest == CAPACITY
