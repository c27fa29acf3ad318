"""Which methods survive which stiff and extreme cases: every case against every method."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.quantity import number, plural
from harness.report.stability.case import Case, CaseResult, cases_of, is_case

_MOST_NAMED = 4


@dataclass(frozen=True)
class Matrix:
    """Cases against methods, whatever their shape, by their labels.

    A pipeline has two where kernels of this program answer some questions, and its library others.
    """

    cases: tuple[Case, ...]
    labels: tuple[str, ...]

    @cached_property
    def rows(self) -> list[tuple[Case, list[CaseResult | None]]]:
        """Each case with what became of it by each method."""
        return [(case, [case.result(label) for label in self.labels]) for case in self.cases]

    @property
    def totals(self) -> list[tuple[str, Counter[str]]]:
        """How often which word stands in each column."""
        columns = zip(*(results for _, results in self.rows), strict=True)
        return [
            (label, Counter(result.word for result in column if result))
            for label, column in zip(self.labels, columns, strict=True)
        ]

    @property
    def sentences(self) -> list[Markup]:
        """A sentence a method: "predictive survives 34 of 36 cases, degrades in 2 (…), refuses 1 (…)"."""
        sentences = []
        for place, (label, counts) in enumerate(self.totals):
            text = Markup("<strong>{}</strong> survives {} of {}").format(
                label, number(counts["survives"]), plural(counts.total(), "case")
            )
            for word, phrase in (("degrades", "degrades in"), ("fails", "fails"), ("refuses", "refuses")):
                if counts[word]:
                    named = [case.title for case, results in self.rows if _is(results[place], word)]
                    text += Markup(", {} {}").format(phrase, number(counts[word]))
                    text += Markup(" ({})").format("; ".join(named)) if len(named) <= _MOST_NAMED else Markup("")
            sentences.append(text + Markup("."))
        return sentences


def matrix(pages: Sequence[ExperimentPage]) -> Matrix | None:
    """The matrix of all experiments that are cases; None where there are none."""
    cases = [case for page in pages if is_case(page) for case in cases_of(page)]
    methods = dict.fromkeys(method for case in cases for method in case.methods)
    # what is exact comes last, as in the files
    order = sorted(methods, key=lambda method: not method.stepped)
    return Matrix(tuple(cases), tuple(dict.fromkeys(method.label for method in order))) if methods else None


def _is(result: CaseResult | None, word: str) -> bool:
    return result is not None and result.word == word
