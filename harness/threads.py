"""Threads that share out the items of one frame, where a run asks for several cores.

Every item is worked on by itself, so that who does which changes no result. Kernels let other threads run meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

Result = TypeVar("Result")

# Parts a thread: pairs differ in what they cost, and with one part each the last thread would be waited for.
_PARTS = 8


class Threads:
    """So many threads, started with the first work that is large enough to be shared.

    Parameters
    ----------
    count : 1 for the caller's alone

    >>> Threads(1).parts(1000, 10)
    ((0, 1000),)
    >>> Threads(2).parts(100, 32)
    ((0, 50), (50, 100))
    """

    def __init__(self, count: int = 1) -> None:
        self.count = count
        self._pool: ThreadPoolExecutor | None = None

    def parts(self, items: int, fewest: int) -> tuple[tuple[int, int], ...]:
        """Where each part of so many items begins and ends; one part where there is nothing to share.

        Parts are as many for each thread: of three parts, one of two threads would do twice the other's work.

        Parameters
        ----------
        items : how many there are
        fewest : in a part; to hand over fewer, at some 10 us a part, would take longer than to do them
        """
        if self.count == 1 or items < 2 * fewest:  # most frames, of which each asks: a microsecond counts
            return ((0, items),)
        parts = min(_PARTS * self.count, items // fewest)
        parts -= parts % self.count if parts > self.count else 0
        return tuple((items * part // parts, items * (part + 1) // parts) for part in range(parts))

    def each(self, work: Callable[[int, int], Result], parts: tuple[tuple[int, int], ...]) -> list[Result]:
        """What comes of every part, in their order. The caller works too, and so never waits for a thread to start."""
        if len(parts) == 1:
            return [work(*parts[0])]
        if self._pool is None:
            from concurrent.futures import ThreadPoolExecutor  # only a run that shares needs it

            self._pool = ThreadPoolExecutor(self.count - 1)
        left, done = iter(enumerate(parts)), dict[int, Result]()

        def take() -> None:
            for place, part in left:  # whoever is free takes the next: only one thread at a time runs Python
                done[place] = work(*part)

        others = [self._pool.submit(take) for _ in range(self.count - 1)]
        take()
        for other in others:
            other.result()
        return [done[place] for place in range(len(parts))]
