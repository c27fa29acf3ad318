"""Counts of the verdicts of two backends on one shape, asked one query."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TypeVar

from harness.vocabulary import Query, Shape

NamePair = tuple[str, str]
"""Of what is compared. A name is opaque everywhere but where it is turned into what is asked."""

LARGEST_DECADE = 16
"""Of the bins of `GapHistogram`: gaps of a tenth of the size and more."""


@dataclass
class Counts:
    """Counts of one pair of backends on one shape, asked one query."""

    backends: NamePair
    shape: Shape
    query: Query = field(default="collision", kw_only=True)

    @property
    def of(self) -> tuple[NamePair, Shape, Query]:
        """What is counted together."""
        return self.backends, self.shape, self.query

    def add(self, other: Counts) -> None:
        """Take in the counts of another scene."""
        for entry in fields(self):
            mine, theirs = getattr(self, entry.name), getattr(other, entry.name)
            if isinstance(mine, int):
                setattr(self, entry.name, mine + theirs)


@dataclass
class Tally(Counts):
    """Their verdicts; `verdicts` is the sum of `agree` and of all kinds of disagreement.

    Poses at which a backend failed have none.
    """

    poses: int = 0
    verdicts: int = 0
    agree: int = 0
    undecided: int = 0
    containment: int = 0
    approximation: int = 0
    real: int = 0


@dataclass
class Approximation(Counts):
    """A backend that replaces the shape by another, as bodies flew, against one that does not.

    Parameters
    ----------
    backend : the one that replaces it
    verdicts : pairs of bodies asked about
    touching : pairs that touch: as both report, or where they differ as the judge finds
    reported : pairs that the backend reports
    false_hits : of those reported, pairs that do not touch
    contained : of the false hits, pairs of which one surface lies inside the other
    misses : of those that touch, pairs not reported
    """

    backend: str = ""
    verdicts: int = 0
    touching: int = 0
    reported: int = 0
    false_hits: int = 0
    contained: int = 0
    misses: int = 0

    @property
    def false_share(self) -> float:
        """Of the hits reported, how many are none; 0 without hits."""
        return self.false_hits / self.reported if self.reported else 0.0

    @property
    def missed_share(self) -> float:
        """Of the pairs that touch, how many are missed; 0 where none does."""
        return self.misses / self.touching if self.touching else 0.0


@dataclass
class CheckedAgreement(Counts):
    """Verdicts that both agree on and that were judged; `contradicted` of them are wrong outside the tolerance."""

    verdicts: int = 0
    contradicted: int = 0


@dataclass
class GapHistogram(Counts):
    """At which gaps they differ.

    Parameters
    ----------
    counts : disagreements by kind and signed decade. Decade k holds gaps from 10^(k-17) to ten times that, of the size
        of the smaller body, -k overlaps as deep, 0 what is nearer than 1e-16
    """

    counts: dict[str, dict[int, int]] = field(default_factory=dict)

    def count(self, kind: str, gap: float) -> None:
        """Count a disagreement at a gap (of size)."""
        decade = decade_of(gap)
        of_kind = self.counts.setdefault(kind, {})
        of_kind[decade] = of_kind.get(decade, 0) + 1

    def add(self, other: Counts) -> None:
        """Take in the counts of another scene."""
        assert isinstance(other, GapHistogram), "counts of one sort are added"
        for kind, decades in other.counts.items():
            mine = self.counts.setdefault(kind, {})
            for decade, count in decades.items():
                mine[decade] = mine.get(decade, 0) + count


def decade_of(gap: float) -> int:
    """The signed decade of a gap (of size), as `GapHistogram` has it.

    >>> [decade_of(gap) for gap in (0.0, 2e-15, -3e-3, 0.5, 7.0)]
    [0, 2, -14, 16, 16]
    """
    if abs(gap) < 1e-16:
        return 0
    decade = min(LARGEST_DECADE, math.floor(math.log10(abs(gap)) + 1e-9) + 17)
    return decade if gap > 0 else -decade


C = TypeVar("C", bound=Counts)


def merge(counts: list[C], more: list[C]) -> None:
    """Add counts to those of the same backends, shape and query, in place."""
    for one in more:
        same = next((c for c in counts if c.of == one.of), None)
        if same is None:
            counts.append(one)
        else:
            same.add(one)
