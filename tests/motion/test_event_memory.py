"""The memory of the event loop."""

from __future__ import annotations

import numpy as np
import pytest

from harness.motion.predictive.memory import HUGE, LINE, aligned, filled


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


def test_a_system_without_huge_pages_gives_ordinary_ones(monkeypatch):
    def refuse(*_, **__):
        raise OSError(22, "Invalid argument")

    monkeypatch.setattr("harness.motion.predictive.memory.mmap.mmap", refuse)
    array = aligned(HUGE // 8, np.float64)
    assert len(array) == HUGE // 8
    assert array.ctypes.data % LINE == 0
