"""A stiff or extreme case, and what became of it by a method, from the verdicts and runs that are stored.

A case is an experiment of the folder `stability`, and of each shape if it has several. A method fails a case where a
run of its did not come to its end or an expectation is broken; it refuses it where its runs were rejected, which always
has a reason; it degrades where a claim is false, for claims say what a method ought to do and a weak one does not; and
it survives all others.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pandas as pd

from harness.measure.limits import Limits, limits
from harness.measure.selection import Columns, matching, which
from harness.report.criteria import as_criterion
from harness.report.experiment import ExperimentPage
from harness.report.methods import methods_of
from harness.report.missing import is_complete
from harness.report.quantity import as_given, leaf_text, number
from harness.store.records import VerdictRow
from harness.vocabulary import MethodName

FOLDER = "stability/"
Word = Literal["survives", "degrades", "fails", "refuses"]

# Signs beside the words, so that a matrix can be taken in at a glance without colours.
SIGNS: dict[str, str] = {"survives": "✓", "degrades": "≈", "fails": "✗", "refuses": "⊘"}
MEANINGS: dict[str, str] = {
    "survives": "all that the case expects and claims holds",
    "degrades": "what is expected holds, what a method ought to do does not",
    "fails": "an expectation is broken, or a run crashed, hung or came to numbers that are not finite",
    "refuses": "the run was rejected, with a reason",
}
_LONGEST = 160


@dataclass(frozen=True)
class CaseResult:
    """What became of a case by one method: a word, and the numbers or the reason behind it."""

    word: Word
    why: str

    @property
    def sign(self) -> str:
        """The word as a sign."""
        return SIGNS[self.word]


@dataclass(frozen=True, eq=False)
class Case:
    """A row: an experiment, or one shape of it."""

    page: ExperimentPage
    shape: str | None

    @property
    def title(self) -> str:
        """Its experiment's, and its shape where there are others."""
        return f"{self.page.record.title}: {self.shape}" if self.shape else self.page.record.title

    @cached_property
    def runs(self) -> pd.DataFrame:
        """Those of the case."""
        return matching(self.page.runs, {"shape": self.shape} if self.shape else {})

    @cached_property
    def methods(self) -> list[MethodName]:
        """That of every run."""
        return methods_of(self.runs)

    def result(self, label: str) -> CaseResult | None:
        """What became of it by the methods of a label, which names who does the work; None where none was run."""
        mine = [place for place, method in enumerate(self.methods) if method.label == label]
        if not mine:
            return None
        record = self.page.record
        ended = [(self._columns["status"][place], self._columns["reason"][place]) for place in mine]
        broken = [f"{status}: {reason}" for status, reason in ended if status not in ("ok", "rejected")]
        if broken:
            return CaseResult("fails", _short(broken[0]))
        expected = list(self._judged(record.expectations, mine))
        if rejected := [reason for status, reason in ended if status == "rejected"]:
            return CaseResult("refuses", _short(str(rejected[0])))
        claimed = list(self._judged(record.claims, mine))
        judged: tuple[tuple[Word, list[tuple[str, str]]], ...] = ("fails", expected), ("degrades", claimed)
        for word, rows in judged:
            false = [text for verdict, text in rows if verdict == "fails"]
            if false:
                return CaseResult(word, "; ".join(dict.fromkeys(false)))
        held = [text for verdict, text in (*expected, *claimed) if verdict == "holds"]
        return CaseResult("survives", held[0] if held else "came to its end")

    @cached_property
    def _columns(self) -> Columns:
        """Of its runs."""
        return Columns(self.runs)

    def _judged(self, rows: Sequence[VerdictRow], mine: Sequence[int]) -> Iterator[tuple[str, str]]:
        """Of every row of `expect` or `claims` that speaks of these runs: its verdict on them, and its worst number."""
        points = list({self._columns["point"][place]: place for place in reversed(mine)}.values())
        for row in rows:
            among = self._which(row.criterion.get("where") or {})[points]
            bounds = limits(as_criterion(row.criterion))
            groups = [
                group
                for group in row.detail.get("groups") or ()
                if (among & self._which(group["parameters"])[points]).any()
            ]
            if groups:
                failing = [group for group in groups if group["verdict"] == "fails"]
                worst = max(failing or groups, key=lambda group: bounds.excess(group["value"]))
                yield worst["verdict"], _number_behind(row.criterion, worst, bounds)

    def _which(self, where: Mapping[str, Any]) -> npt.NDArray[np.bool_]:
        """Of every run, whether its leaves have these values; asked of the same ones by every method."""
        key = json.dumps(where, sort_keys=True)
        if key not in self._found:
            self._found[key] = which(self._columns, where)
        return self._found[key]

    @cached_property
    def _found(self) -> dict[str, npt.NDArray[np.bool_]]:
        return {}


def is_case(page: ExperimentPage) -> bool:
    """Whether an experiment is a case of the matrix."""
    return page.record.name.startswith(FOLDER)


def cases_of(page: ExperimentPage) -> list[Case]:
    """The cases that an experiment makes: one, or one a shape."""
    if page.runs.empty or not is_complete(page.record):
        return []
    shapes = [str(shape) for shape in page.runs["shape"].unique()]
    return [Case(page, shape) for shape in shapes] if len(shapes) > 1 else [Case(page, None)]


def _number_behind(criterion: Mapping[str, Any], group: Mapping[str, Any], bounds: Limits) -> str:
    """A number and the limit that it keeps or breaks: "energy drift 3 × 10⁻¹³ ≤ 10⁻¹²"."""
    name = str(criterion["metric"]).replace("_", " ")
    if criterion.get("ratio_to"):
        name += f" to that of {', '.join(leaf_text(value) for value in criterion['ratio_to'].values())}"
    elif criterion.get("exponent_of"):
        name += f", exponent of {criterion['exponent_of']}"
    if group["value"] is None:
        return f"{name} unknown"
    return (
        f"{name} {number(group['value'])}{', not' if group['verdict'] == 'fails' else ''} {_limit(criterion, bounds)}"
    )


def _limit(criterion: Mapping[str, Any], bounds: Limits) -> str:
    if criterion.get("at_most") is not None:
        return f"≤ {_declared(bounds.high)}"
    if criterion.get("at_least") is not None:
        return f"≥ {_declared(bounds.low)}"
    if criterion.get("equals") is not None:
        return f"= {_declared(criterion['equals'])}"
    return f"in {_declared(bounds.low)} … {_declared(bounds.high)}"


def _declared(value: float) -> str:
    """A limit as a person sets it: 10⁻¹² where a measured number would be 1.00 × 10⁻¹²."""
    return number(value) if float(value).is_integer() and abs(value) < 1e15 else as_given(value)


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1].rstrip()}…"
