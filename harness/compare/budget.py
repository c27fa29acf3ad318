"""How much a comparison may ask: so many seconds, and every n-th pose."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import NamedTuple


class LeftOut(NamedTuple):
    """What was not asked.

    Attributes
    ----------
    what : that others may have in common with it
    which : what tells it from those; empty if nothing does
    how : how much of it, and why; empty where `what` is all that is to be said
    """

    what: str
    which: str = ""
    how: str = ""


def in_sentences(left: Iterable[LeftOut]) -> list[str]:
    """A sentence for each thing that was left out, with all that has it in common.

    >>> in_sentences([LeftOut("2 bodies", f"sizes 1 to {n} m", "not asked") for n in (10, 50)] * 2)
    ['2 bodies, sizes 1 to 10 m; sizes 1 to 50 m: not asked']
    """
    whiches: dict[tuple[str, str], dict[str, None]] = {}
    for one in left:
        whiches.setdefault((one.what, one.how), {})[one.which] = None
    lines = []
    for (what, how), named in whiches.items():
        of_all = ", ".join(filter(None, (what, "; ".join(filter(None, named)))))
        lines.append(f"{of_all}: {how}" if how else of_all)
    return lines


class Budget:
    """Seconds that a comparison may take, from now on, and what was left out when they were spent.

    Parameters
    ----------
    seconds : None for as long as it takes
    every : of the poses of a scene ask about every n-th

    Attributes
    ----------
    left : what was left out, one after another
    """

    def __init__(self, seconds: float | None = None, every: int = 1) -> None:
        self.seconds, self.every = seconds, every
        self.left: list[LeftOut] = []
        self._end = None if seconds is None else monotonic() + seconds
        self._shares = 1

    @property
    def left_out(self) -> list[str]:
        """What was left out, in sentences, each thing once."""
        return in_sentences(self.left)

    def leave_out(self, what: str, which: str = "", how: str = "") -> None:
        """Keep what is left out; see `LeftOut`."""
        self.left.append(LeftOut(what, which, how))

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
