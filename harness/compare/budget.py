"""How much a comparison may ask: so many seconds, and every so many poses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic


class Budget:
    """Seconds that a comparison may take, from now on, and what was left out when they were spent.

    Parameters
    ----------
    seconds : None for as long as it takes
    every : of the poses of a scene ask about every n-th

    Attributes
    ----------
    left_out : sentences
    """

    def __init__(self, seconds: float | None = None, every: int = 1) -> None:
        self.seconds, self.every = seconds, every
        self.left_out: list[str] = []
        self._end = None if seconds is None else monotonic() + seconds

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Time that does not count: kernels are compiled once for all that is asked later, too."""
        began = monotonic()
        yield
        if self._end is not None:
            self._end += monotonic() - began

    @property
    def spent(self) -> bool:
        """Whether the time is over."""
        return self._end is not None and monotonic() >= self._end
