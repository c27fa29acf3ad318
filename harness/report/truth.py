"""What engines answered to sets of cases with proven times of impact, as the report has it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from harness.store.records import ComparisonRecord
from harness.vocabulary import OWN, PipelineName

ALL = "all"
"""The row of all families together."""
UNSAFE = ("missed", "late", "false")
"""Answers that let bodies pass into each other, or stop them for nothing."""
OTHERS = ("early", "failed")


@dataclass(frozen=True, eq=False)
class TruthPart:
    """One set of cases, and all who were asked about it.

    Parameters
    ----------
    name : of the set
    asked : by who was asked, what the database has of its answers
    """

    name: str
    asked: Mapping[str, Mapping[str, Any]]

    @property
    def engines(self) -> list[str]:
        """Who could be asked, the engine of this program first."""
        able = [label for label, found in self.asked.items() if not found["problem"]]
        return sorted(able, key=lambda label: (label != OWN, label))

    def heading(self, engine: str) -> str:
        """An engine in few letters: of one that is stepped its library and the step."""
        found = self.asked[engine]
        return f"{PipelineName.read(found['backend']).backend}, dt {_step(found['dt'])}" if found["dt"] else engine

    @cached_property
    def families(self) -> list[str]:
        """In the order of the set, without that of all."""
        named = [family for engine in self.engines for family in self.asked[engine]["families"]]
        return [family for family in dict.fromkeys(named) if family != ALL]

    def count(self, engine: str, family: str) -> Mapping[str, Any] | None:
        """What an engine answered to a family; None where it was asked nothing."""
        found: Mapping[str, Any] | None = self.asked[engine]["families"].get(family)
        return found if found is not None and found["asked"] else None


@dataclass(frozen=True, eq=False)
class TruthResults:
    """All answers of a database.

    Parameters
    ----------
    records : of engines that were asked about a set
    """

    records: Sequence[ComparisonRecord]

    @cached_property
    def parts(self) -> list[TruthPart]:
        """A part for every set."""
        found: dict[str, dict[str, Mapping[str, Any]]] = {}
        for record in self.records:
            found.setdefault(record.experiment, {})[record.backends[0]] = record.document["truth"]
        return [TruthPart(name, asked) for name, asked in sorted(found.items())]


def _step(seconds: float) -> str:
    """A step as people write it.

    >>> _step(1 / 60), _step(0.3)
    ('1/60 s', '0.3 s')
    """
    steps = 1.0 / seconds
    return f"1/{steps:.0f} s" if steps > 1.0 and math.isclose(steps, round(steps), rel_tol=1e-9) else f"{seconds:.6g} s"
