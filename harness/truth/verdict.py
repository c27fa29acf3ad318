"""Whether what was told of cases is right: inside of the bounds, or out of them by no more than the tolerance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any, Literal

from harness.pair.distance import distance
from harness.truth.answerers import Answer
from harness.truth.case_scene import CaseScenes
from harness.truth.cases import Cases

WITHIN = 1e-9
"""s by which a time may be out of its bounds."""

_ROUNDING = 1e-14  # of the mean size: many times what `distance` rounds by

Verdict = Literal["right", "missed", "late", "early", "false", "failed"]
VERDICTS: tuple[Verdict, ...] = ("right", "missed", "late", "early", "false", "failed")


@dataclass
class FamilyCount:
    """What was found of one family.

    Parameters
    ----------
    verdicts : how many of each
    seconds : of CPU time, of each case that was answered
    latest, earliest : s, by how much a time was after its upper bound, or before its lower one, at the most
    without : cases of shapes that it does not have, which were not asked
    """

    verdicts: dict[Verdict, int] = field(default_factory=lambda: dict.fromkeys(VERDICTS, 0))
    seconds: list[float] = field(default_factory=list)
    latest: float = 0.0
    earliest: float = 0.0
    without: int = 0

    @property
    def asked(self) -> int:
        """Cases."""
        return sum(self.verdicts.values())

    def document(self) -> dict[str, Any]:
        """For JSON; times in s."""
        return {
            "asked": self.asked,
            **{str(verdict): number for verdict, number in self.verdicts.items()},
            "without_shape": self.without,
            "latest": self.latest,
            "earliest": self.earliest,
            "seconds_a_query": median(self.seconds) if self.seconds else None,
        }


class Verdicts:
    """Of one who was asked, by family.

    Parameters
    ----------
    cases : Cases
    scenes : their bodies
    within : s

    Attributes
    ----------
    counts : Count by family
    problem : why it could not be asked at all; empty if it could
    failures : how many cases failed, by why
    """

    def __init__(self, cases: Cases, scenes: CaseScenes, within: float) -> None:
        self._cases, self._scenes, self._within = cases, scenes, within
        self.counts: dict[str, FamilyCount] = {}
        self.problem = ""
        self.failures: dict[str, int] = {}

    def add(self, row: int, answer: Answer | str | None) -> None:
        """Count what was told of a case: an answer, why there is none, or None where it has no such shape."""
        count = self.counts.setdefault(str(self._cases.families[row]), FamilyCount())
        if answer is None:
            count.without += 1
            return
        if isinstance(answer, str):
            count.verdicts["failed"] += 1
            self.failures[answer] = self.failures.get(answer, 0) + 1
            return
        count.seconds.append(answer.seconds)
        count.verdicts[self._verdict(row, answer)] += 1
        upper = float(self._cases.upper[row])
        if math.isfinite(upper) and math.isfinite(answer.time):
            count.latest = max(count.latest, answer.time - upper)
            count.earliest = max(count.earliest, float(self._cases.lower[row]) - answer.time)

    def total(self) -> FamilyCount:
        """Of all families."""
        whole = FamilyCount()
        for count in self.counts.values():
            for verdict in VERDICTS:
                whole.verdicts[verdict] += count.verdicts[verdict]
            whole.seconds += count.seconds
            whole.latest, whole.earliest = max(whole.latest, count.latest), max(whole.earliest, count.earliest)
            whole.without += count.without
        return whole

    def named(self) -> Mapping[str, FamilyCount]:
        """By family, in the order of the set, and of all of them."""
        ordered = dict.fromkeys(self._cases.families.tolist())
        return {**{name: self.counts[name] for name in ordered if name in self.counts}, "all": self.total()}

    def _verdict(self, row: int, answer: Answer) -> Verdict:
        lower, upper, time = float(self._cases.lower[row]), float(self._cases.upper[row]), answer.time
        if math.isinf(upper):
            return "right" if math.isinf(time) or self._near(row, time, answer.tolerance) else "false"
        if math.isinf(time):
            return "missed"
        out = max(lower - time, time - upper)
        if out <= self._within or self._near(row, lower - out, answer.tolerance):
            return "right"
        return "late" if time > upper else "early"

    def _near(self, row: int, time: float, tolerance: float) -> bool:
        """Whether the gap at a time, s, is no more than a tolerance, m; before the start nothing is."""
        if time < 0.0:
            return False
        a, b = self._scenes.bodies(row, time)
        return bool(distance(a, b).gap <= tolerance + _ROUNDING * (a.size + b.size) / 2.0)
