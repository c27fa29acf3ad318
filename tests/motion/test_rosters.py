"""Rosters against Python's own lists, and the memory that they lie in."""

from __future__ import annotations

import numpy as np
import pytest

from harness.kernel import loop
from harness.motion.predictive.memory import HUGE, LINE, aligned, filled
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


@pytest.mark.parametrize("count", [1, HUGE // 8 - 1, HUGE // 8, 3 * HUGE // 8 + 5])
def test_memory_begins_on_a_line_and_holds_zeros(count):
    arrays = [aligned(count, np.float64) for _ in range(3)]
    for array in arrays:
        assert len(array) == count
        assert array.ctypes.data % LINE == 0
        assert not array.any()
    arrays[1][:] = 1.0
    assert not arrays[0].any()
    assert not arrays[2].any()
    assert (filled(count, np.inf, np.float64) == np.inf).all()


def test_large_arrays_do_not_begin_at_the_same_place_of_a_huge_page():
    """Else all would share the sets of the cache."""
    begins = [aligned(HUGE // 8, np.float64).ctypes.data % HUGE for _ in range(8)]
    assert len(set(begins)) == len(begins)
