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
        self._shares = 1

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Time that does not count: kernels are compiled once for all that is asked later, too."""
        began = monotonic()
        yield
        if self._end is not None:
            self._end += monotonic() - began

    @contextmanager
    def share(self, parts: int) -> Iterator[None]:
        """No more than one of so many equal parts of what is left, so that one question leaves some to others."""
        if self._end is None:
            yield
            return
        whole, now = self._end, monotonic()
        self._end = mine = now + max(0.0, whole - now) / parts
        self._shares = parts
        yield
        self._shares = 1
        self._end += whole - mine  # what was paused does not count for the whole either

    @property
    def spent(self) -> bool:
        """Whether the time is over."""
        return self._end is not None and monotonic() >= self._end

    @property
    def why(self) -> str:
        """Why it is spent, as the end of a sentence."""
        assert self.seconds is not None
        return f"{self.seconds:g} s were spent" if self._shares == 1 else f"its share of {self.seconds:g} s was spent"
