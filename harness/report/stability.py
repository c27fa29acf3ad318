"""Which methods survive which stiff and extreme cases: a matrix, made of the verdicts and runs that are stored.

A case is an experiment of the folder `stability`, and of each shape if it has several. A method fails a case where a
run of its did not come to its end or an expectation is broken; it refuses it where its runs were rejected, which always
has a reason; it degrades where a claim is false, for claims say what a method ought to do and a weak one does not; and
it survives all others.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import pandas as pd
from markupsafe import Markup

from harness.measure.limits import Limits, limits
from harness.measure.selection import matching, which
from harness.report.criteria import as_criterion
from harness.report.missing import is_complete
from harness.report.pages import ExperimentPage
from harness.report.quantity import leaf_text, number, plural
from harness.store.records import VerdictRow

FOLDER = "stability/"
Word = Literal["survives", "degrades", "fails", "refuses"]

# Signs beside the words, so that a matrix can be taken in at a glance without colours.
SIGNS: dict[str, str] = {"survives": "✓", "degrades": "≈", "fails": "✗", "refuses": "⊘"}
MEANINGS: dict[str, str] = {
    "survives": "all that the case expects and claims holds",
    "degrades": "what is expected holds, what a method ought to do does not",
    "fails": "an expectation is broken, or a run crashed, hung or lost its numbers",
    "refuses": "the run was rejected, with a reason",
}
_MOST_NAMED = 4
_LONGEST = 160


@dataclass(frozen=True)
class Method:
    """A way to find hits, as a column has it."""

    backend: str
    algorithm: str

    @property
    def label(self) -> str:
        """ "predictive", "brute-force (fcl)"."""
        return self.algorithm if self.algorithm == "predictive" else f"{self.algorithm} ({self.backend})"


@dataclass(frozen=True)
class Fate:
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

    @property
    def href(self) -> str:
        """Its page, from the pages at the top."""
        return f"{self.page.folder}/index.html"

    @cached_property
    def runs(self) -> pd.DataFrame:
        """Those of the case."""
        return matching(self.page.runs, {"shape": self.shape} if self.shape else {})

    @property
    def methods(self) -> list[Method]:
        """Those it was flown by, in the order of its points."""
        pairs = self.runs[["backend", "algorithm"]].drop_duplicates()
        return [Method(str(backend), str(algorithm)) for backend, algorithm in pairs.itertuples(index=False)]

    def fate(self, method: Method) -> Fate | None:
        """What became of it by a method; None where it was not flown by it."""
        mine = matching(self.runs, {"backend": method.backend, "algorithm": method.algorithm})
        if mine.empty:
            return None
        record = self.page.record
        broken = mine[~mine["status"].isin(("ok", "rejected"))]
        if len(broken):
            return Fate("fails", _short(f"{broken['status'].iloc[0]}: {broken['reason'].iloc[0]}"))
        expected = list(self._judged(record.expectations, mine))
        if rejected := mine[mine["status"] == "rejected"]["reason"].tolist():
            return Fate("refuses", _short(str(rejected[0])))
        claimed = list(self._judged(record.claims, mine))
        for word, rows in (("fails", expected), ("degrades", claimed)):
            false = [text for verdict, text in rows if verdict == "fails"]
            if false:
                return Fate("fails" if word == "fails" else "degrades", "; ".join(dict.fromkeys(false)))
        held = [text for verdict, text in (*expected, *claimed) if verdict == "holds"]
        return Fate("survives", held[0] if held else "came to its end")

    def _judged(self, rows: Sequence[VerdictRow], mine: pd.DataFrame) -> Iterator[tuple[str, str]]:
        """Of every row of `expect` or `claims` that speaks of these runs: its verdict on them, and its worst number."""
        points = mine.drop_duplicates("point")
        for row in rows:
            among = which(points, row.criterion.get("where") or {})
            bounds = limits(as_criterion(row.criterion))
            groups = [
                group for group in row.detail.get("groups") or () if (among & which(points, group["parameters"])).any()
            ]
            if groups:
                failing = [group for group in groups if group["verdict"] == "fails"]
                worst = max(failing or groups, key=lambda group: bounds.excess(group["value"]))
                yield worst["verdict"], _number_behind(row.criterion, worst, bounds)


@dataclass(frozen=True)
class Matrix:
    """Cases against methods."""

    cases: tuple[Case, ...]
    methods: tuple[Method, ...]

    @cached_property
    def rows(self) -> list[tuple[Case, list[Fate | None]]]:
        """Each case with what became of it by each method."""
        return [(case, [case.fate(method) for method in self.methods]) for case in self.cases]

    @property
    def totals(self) -> list[tuple[Method, Counter[str]]]:
        """How often which word stands in each column."""
        columns = zip(*(fates for _, fates in self.rows), strict=True)
        return [
            (method, Counter(fate.word for fate in column if fate))
            for method, column in zip(self.methods, columns, strict=True)
        ]

    @property
    def sentences(self) -> list[Markup]:
        """A sentence a method: "predictive survives 34 of 36 cases, degrades in 2 (…), refuses 1 (…)"."""
        said = []
        for place, (method, counts) in enumerate(self.totals):
            text = Markup("<strong>{}</strong> survives {} of {}").format(
                method.label, number(counts["survives"]), plural(counts.total(), "case")
            )
            for word, phrase in (("degrades", "degrades in"), ("fails", "fails"), ("refuses", "refuses")):
                if counts[word]:
                    named = [case.title for case, fates in self.rows if _is(fates[place], word)]
                    text += Markup(", {} {}").format(phrase, number(counts[word]))
                    text += Markup(" ({})").format("; ".join(named)) if len(named) <= _MOST_NAMED else Markup("")
            said.append(text + Markup("."))
        return said


def matrix(pages: Sequence[ExperimentPage]) -> Matrix | None:
    """The matrix of all experiments that are cases; None where there are none."""
    cases = [case for page in pages if is_case(page) for case in _cases(page)]
    methods = dict.fromkeys(method for case in cases for method in case.methods)
    # what is exact comes last, as in the files
    order = sorted(methods, key=lambda method: method.algorithm == "predictive")
    return Matrix(tuple(cases), tuple(order)) if methods else None


def is_case(page: ExperimentPage) -> bool:
    """Whether an experiment is a case of the matrix."""
    return page.record.name.startswith(FOLDER)


def _cases(page: ExperimentPage) -> list[Case]:
    if page.runs.empty or not is_complete(page.record):
        return []
    shapes = [str(shape) for shape in page.runs["shape"].unique()]
    return [Case(page, shape) for shape in shapes] if len(shapes) > 1 else [Case(page, None)]


def _is(fate: Fate | None, word: str) -> bool:
    return fate is not None and fate.word == word


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
    if 1e-4 <= abs(value) < 1e15:
        return number(value) if float(value).is_integer() else f"{value:g}".replace("-", "−")
    return re.sub(r"^1\D+(?=10)", "", re.sub(r"\.?0+(?=\D)", "", number(value), count=1))


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1].rstrip()}…"
