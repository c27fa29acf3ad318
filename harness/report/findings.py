"""What an experiment found, in sentences with numbers and intervals; and what to beware of in it."""

from __future__ import annotations

import html
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from harness.report.atlas import AtlasPart
from harness.report.criteria import refusals
from harness.report.missing import is_judged
from harness.report.quantity import number, plural, quantity
from harness.report.ranking import Growth
from harness.report.sentences.atlas import atlas_sentences
from harness.report.sentences.credit import credit_sentences
from harness.report.sentences.crossings import crossing_sentences
from harness.report.sentences.growth import change_sentences, exponent_sentences
from harness.report.sentences.leaders import leader_sentences
from harness.report.sentences.warnings import warning_sentences
from harness.report.series import Arrangement
from harness.report.words import is_noisy, metric_title, metric_unit, verdicts_text
from harness.store.records import ExperimentRecord, VerdictRow


@dataclass(frozen=True)
class Findings:
    """Sentences for a page: what was found, what was broken or failed, and what to beware of."""

    sentences: tuple[Markup, ...]
    failures: tuple[Markup, ...]
    warnings: tuple[Markup, ...]

    @property
    def answer(self) -> Markup:
        """The one sentence for a card."""
        return (*self.sentences, *self.failures, Markup("Nothing was measured yet."))[0]


def findings(
    record: ExperimentRecord, arrangement: Arrangement, growths: Sequence[Growth], surveyed: Sequence[AtlasPart] = ()
) -> Findings:
    """The findings of an experiment; `surveyed` is what engines were found to say of its families of poses."""
    sentences = [
        *(Markup(html.escape(sentence, quote=False)) for sentence in atlas_sentences(surveyed)),
        *leader_sentences(arrangement),
        *crossing_sentences(arrangement),
        *exponent_sentences(arrangement, growths),
        *change_sentences(arrangement),
    ]
    if sentences and not surveyed:  # which name methods
        sentences += credit_sentences(arrangement)
    sentences += _outcomes([row for row in record.claims if is_judged(row)], "claim")
    # the one run of an experiment with families has no frames: its poses are asked by a comparison
    families = (record.specification.get("measure") or {}).get("families")
    if not sentences and not families and any(not point.good.empty for point in arrangement.points):
        sentences += _single(arrangement)
    kept = [row for row in record.expectations if row.verdict == "holds"]
    if record.expectations and len(kept) == len(record.expectations):
        sentences.append(Markup("What was expected holds: {}.").format(plural(len(kept), "expectation")))
    failures = [
        Markup("Expectation <strong>{}</strong>: {}").format(
            "broken" if row.verdict == "fails" else row.verdict, _ended(row.statement)
        )
        for row in record.expectations
        if row.verdict != "holds" and is_judged(row)
    ]
    return Findings(
        tuple(sentences), (*failures, *_failed_runs(record, arrangement)), tuple(warning_sentences(record, arrangement))
    )


def _outcomes(verdicts: Sequence[VerdictRow], noun: str) -> list[Markup]:
    if not verdicts:
        return []
    listed = verdicts_text(row.verdict for row in verdicts)
    held = Markup("{}: <strong>{}</strong>.").format(f"{noun}s".capitalize(), listed)
    false = [Markup("False: {}").format(_ended(row.statement)) for row in verdicts if row.verdict == "fails"]
    return [held, *false]


def _single(arrangement: Arrangement) -> list[Markup]:
    """The plain numbers, where there is nothing to compare."""
    point = next(point for point in arrangement.points if not point.good.empty)
    metrics = [*arrangement.metrics, "run_seconds", "frames_per_second", "events"]
    parts = [
        Markup("{} <strong>{}</strong>").format(
            metric_title(metric), quantity(point.median(metric), metric_unit(metric))
        )
        for metric in dict.fromkeys(metrics)
        # a clock that stands at 0 is of what was not done at all
        if point.summary(metric) and not (is_noisy(metric) and point.median(metric) == 0.0)
    ]
    return [Markup("{}.").format(Markup(", ").join(parts))] if parts else []


def _failed_runs(record: ExperimentRecord, arrangement: Arrangement) -> list[Markup]:
    ended = Counter(str(status) for point in arrangement.points for status in point.runs["status"])
    refused = sum(refusals(record, point.runs) for point in arrangement.points)
    total, good = sum(ended.values()), ended.pop("ok", 0) + refused
    ended["rejected"] -= refused
    ended = +ended
    found = []
    if total > good:
        kinds = ", ".join(f"{number(count)} {status}" for status, count in sorted(ended.items()))
        found.append(
            Markup("<strong>{} of {}</strong> did not end well: {}.").format(
                number(total - good), plural(total, "run"), kinds
            )
        )
    return found


def _ended(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."
