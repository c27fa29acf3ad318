"""Memory of the event loop: arrays that begin on a cache line, the large ones in huge pages.

Events are anywhere in memory, so that with 10^5 spheres and pages of 4 KiB most reads first wait for the address: huge
pages gave 1.04 to 1.09 times the rate. A system may promise them and give small ones: arrays that all began at the same
place of a huge page then shared the sets of the cache, which cost a sixth of the rate at packing .45.
"""

from __future__ import annotations

import mmap
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Bytes = NDArray[np.uint8]

LINE = 64  # bytes of a cache line
HUGE = 1 << 21  # bytes of a huge page
# Where in its first huge page an array begins: each so many lines behind the one before.
_begins = cycle(range(0, 1 << 16, 37 * LINE))


def aligned(count: int, kind: DTypeLike) -> Any:
    """(count,) zeros of a type, that start on a cache line."""
    kind = np.dtype(kind)
    size = count * kind.itemsize
    raw, skip = (_in_huge_pages(size) if size >= HUGE else None) or _on_a_line(size)
    return raw[skip : skip + size].view(kind)


def _on_a_line(size: int) -> tuple[Bytes, int]:
    raw = np.zeros(size + LINE, dtype=np.uint8)
    return raw, -raw.ctypes.data % LINE


def _in_huge_pages(size: int) -> tuple[Bytes, int] | None:
    """None where the system has none, or not the room for them."""
    if not hasattr(mmap, "MADV_HUGEPAGE"):
        return None
    try:
        pages = mmap.mmap(-1, size + 2 * HUGE, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
        pages.madvise(mmap.MADV_HUGEPAGE)
    except OSError:
        return None
    raw = np.frombuffer(pages, dtype=np.uint8)
    return raw, -raw.ctypes.data % HUGE + next(_begins)


def filled(count: int, value: float, kind: DTypeLike) -> Any:
    """(count,) of one value, likewise."""
    array = aligned(count, kind)
    array[:] = value
    return array
