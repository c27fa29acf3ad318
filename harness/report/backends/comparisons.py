"""The comparisons of backends: what all of them together have found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from harness.store.records import ComparisonRecord

KINDS = ("undecided", "containment", "approximation", "real")
"""Of disagreements: inside the tolerance band, one surface inside the other, a hull for a mesh, none of these."""


@dataclass(frozen=True, eq=False)
class Comparisons:
    """What was found of backends that were asked about the same poses.

    Parameters
    ----------
    records : the newest comparison of every two backends on every experiment
    """

    records: Sequence[ComparisonRecord]

    @property
    def of_two(self) -> Comparisons:
        """Those of two backends, without the atlases, which hold one against exact arithmetic."""
        return Comparisons([record for record in self.records if not record.document.get("atlas")])

    @cached_property
    def pairs(self) -> list[dict[str, Any]]:
        """The tallies of all records, each with its experiment."""
        return [
            tally | {"experiment": record.experiment}
            for record in self.records
            for tally in record.document["pairs"]
            if tally["verdicts"]
        ]

    @cached_property
    def failures(self) -> list[str]:
        """Poses at which a backend crashed, hung or raised, in a sentence each."""
        return [
            "{}: {} at {pose} (question {call}): {reason}".format(
                record.experiment, case["wrong"], **case["certificate"]
            )
            for record in self.records
            for case in record.document["cases"]
            if case["certificate"]["kind"] == "crashed"
        ]

    @cached_property
    def findings(self) -> dict[str, list[str]]:
        """By method, what else is wrong with it: what it claims, or verdicts that do not depend on the pose alone."""
        found: dict[str, dict[str, None]] = {}
        for record in self.records:
            for row in record.document.get("findings") or ():
                found.setdefault(row["wrong"], {})[row["certificate"]["reason"]] = None
        return {name: list(reasons) for name, reasons in sorted(found.items())}

    @cached_property
    def unsupported(self) -> list[str]:
        """What could not be compared, and why."""
        lines = [line for record in self.records for line in record.document["unsupported"]]
        return list(dict.fromkeys(lines))

    @cached_property
    def left_out(self) -> list[str]:
        """What was not asked, because the time for it was spent; databases of before it could be know nothing of it."""
        lines = [
            f"{record.experiment}: {line}" for record in self.records for line in record.document.get("left_out") or ()
        ]
        return list(dict.fromkeys(lines))

    @cached_property
    def commands(self) -> list[str]:
        """How it was made."""
        return list(dict.fromkeys(record.command for record in self.records))

    @property
    def cases(self) -> list[dict[str, Any]]:
        """Every wrong verdict and every failure, those last that two backends share."""
        return [case for record in self.records for case in [*record.document["cases"], *record.document["shared"]]]
