"""What to beware of in an experiment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from markupsafe import Markup

from harness.measure.metrics import METRICS
from harness.measure.statistics import NOISY_ABOVE
from harness.report.point import BUSY_ABOVE, MeasuredPoint
from harness.report.quantity import number, plural
from harness.report.series import Arrangement
from harness.report.words import capital, metric_title
from harness.store.records import ExperimentRecord
from harness.vocabulary import ILL_POSED, MethodName

_EXACT = tuple(name for name, metric in METRICS.items() if metric.exact)
# Of several counts that change, these are told first.
_FIRST = ("pair_hits", "missed_hits", "near_pairs")


def warning_sentences(record: ExperimentRecord, arrangement: Arrangement) -> list[Markup]:
    """What a reader should know before believing a page: first what is wrong, last what is merely unsure."""
    return [
        *_of_plans(arrangement.points),
        *_of_correctness(arrangement.points),
        *_of_flights(arrangement.points),
        *_of_measuring(record, arrangement),
    ]


def _of_plans(points: Sequence[MeasuredPoint]) -> Iterator[Markup]:
    """What the plans of the points warn of, such as an approximation."""
    points_of: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        for text in dict.fromkeys(point.row.plan.get("warnings") or ()):
            points_of.setdefault(str(text), []).append(point)
    for text, warned in points_of.items():
        whole = len(warned) == len(points)
        whom = "every point" if whole else f"{number(len(warned))} of {plural(len(points), 'point')}"
        yield Markup("<strong>{}</strong> ({}).").format(capital(text.rstrip(".")), whom)


def _of_correctness(points: Sequence[MeasuredPoint]) -> Iterator[Markup]:
    """Whose answers are wrong, in dispute, or different each time."""
    disagreeing = [point for point in points if point.disagrees]
    if disagreeing:
        yield Markup(
            "<strong>{} hits that the reference does not, or misses some</strong>: struck through, never ranked."
        ).format(f"{plural(len(disagreeing), 'point')} {'reports' if len(disagreeing) == 1 else 'report'}")
    proven = dict.fromkeys(MethodName.of(point.parameters).pipeline for point in points if point.proven_wrong)
    if proven:
        yield Markup(
            "<strong>{} proven wrong</strong> at poses of this experiment, or failed at them: never ranked."
        ).format(f"{' and '.join(proven)} {'was' if len(proven) == 1 else 'were'}")
    doubted = [point for point in points if point.disputed]
    if doubted:
        names = dict.fromkeys(MethodName.of(point.parameters).label for point in doubted)
        yield Markup(
            "<strong>{} saw different hits of the same motion</strong> in {}: nobody is ranked there until it is "
            "known who is right, which <code>harness compare</code> finds out."
        ).format(" and ".join(names), plural(len(doubted), "point"))
    yield from _not_the_same_twice(points)


def _of_flights(points: Sequence[MeasuredPoint]) -> Iterator[Markup]:
    """Where a motion went out of bounds."""
    escaped = [point for point in points if (point.values("escaped") > 0).any()]
    if escaped:
        yield Markup("<strong>Bodies left the box</strong> in {}.").format(plural(len(escaped), "point"))
    guarded = [point for point in points if (point.values("guarded_hits") > 0).any()]
    if guarded:
        most = max(point.values("guarded_hits").max() for point in guarded)
        yield Markup(
            "<strong>Inelastic collapse</strong> in {}: after a long burst of hits, up to {} more were "
            "answered elastically (TC model), so that the flight could go on."
        ).format(plural(len(guarded), "point"), number(most))
    stalled = [point for point in points if (point.values("stalled_events") > 0).any()]
    if stalled:
        most = max(point.values("stalled_events").max() for point in stalled)
        yield Markup(
            "<strong>Bodies had to wait</strong> in {}, up to {} times: too many events came in one burst. So it is "
            "where bodies begin inside one another or have no room, and such a motion is {}. So it is too where the "
            "search for a contact is given up, and taken up again a moment later."
        ).format(plural(len(stalled), "point"), number(most), ILL_POSED)


def _of_measuring(record: ExperimentRecord, arrangement: Arrangement) -> Iterator[Markup]:
    """What was not measured, or not on a quiet machine of its own."""
    points = arrangement.points
    if any("timing_grade" in point.good and not point.good["timing_grade"].all() for point in points):
        yield Markup(
            "<strong>Some runs are not timing-grade</strong>: they shared a machine with other runs. "
            "Counts are exact, times are not."
        )
    asked = arrangement.metrics if (record.specification.get("report") or {}).get("y") else ()
    unreported = [name for name in asked if not any(len(point.values(name)) for point in points)]
    if unreported and any(not point.good.empty for point in points):
        yield Markup("No run reports {}, which the experiment asks for.").format(", ".join(unreported))
    where = {machine for point in points for machine in point.runs["machine"]}
    if len(where) > 1:
        yield Markup("<strong>Runs come from {} machines</strong>: times compare only within one.").format(len(where))
    busy = [point for point in points if point.elapsed_ratio > BUSY_ABOVE]
    if busy:
        yield Markup(
            "The machine was busy: elapsed time is more than {} times the CPU time in {} of {}. "
            "CPU time leads on this page."
        ).format(f"{BUSY_ABOVE:g}", number(len(busy)), plural(len(points), "point"))
    if arrangement.noise == "noisy":
        yield Markup("Noisy: fewer than nine in ten medians are known to {}.").format(f"±{NOISY_ABOVE * 100:.0f} %")


def _not_the_same_twice(points: Sequence[MeasuredPoint]) -> list[Markup]:
    """Methods whose runs of one motion count otherwise, a sentence each: every run begins with the same numbers."""
    changing: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        if len(point.good) > 1 and any(np.ptp(point.values(name)) > 0.0 for name in _EXACT if len(point.values(name))):
            changing.setdefault(MethodName.of(point.parameters).label, []).append(point)
    sentences = []
    for method, where in changing.items():
        name = next(name for name in (*_FIRST, *_EXACT) if len(where[0].values(name)) and np.ptp(where[0].values(name)))
        values = where[0].values(name)
        sentences.append(
            Markup(
                "<strong>{} is not the same twice</strong> in {}: in runs of one and the same motion {} from {} to {}."
            ).format(method, plural(len(where), "point"), metric_title(name), *map(number, (min(values), max(values))))
        )
    return sentences
