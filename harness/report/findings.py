"""What an experiment found, in sentences with numbers and intervals; and what to beware of in it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from harness.measure.noise import told_apart
from harness.measure.statistics import CONFIDENCE, NOISY_ABOVE, Summary
from harness.report.criteria import refusals
from harness.report.crossings import crossing_sentences
from harness.report.missing import is_judged
from harness.report.quantity import exponent_text, number, plural, quantity
from harness.report.ranking import Growth, Ranked, rank, times_worse
from harness.report.series import Arrangement, Cell, Series
from harness.report.tables import SLOW_ELAPSED, elapsed_ratio
from harness.report.words import SCENE_LEAVES, is_clock, metric_title, metric_unit, more_is_better, scene_text, setting
from harness.store.records import ExperimentRecord, VerdictRow

_MOST_EXPONENTS = 8
_WIDEST = 2.0
# Of an experiment's points, how many must be stable for it to be called so.
STABLE_SHARE = 0.9


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


def findings(record: ExperimentRecord, arrangement: Arrangement, growths: Sequence[Growth]) -> Findings:
    """The findings of an experiment."""
    sentences = [
        *_fastest(arrangement),
        *crossing_sentences(arrangement),
        *_exponents(arrangement, growths),
        *_change(arrangement),
    ]
    sentences += _outcomes([row for row in record.claims if is_judged(row)], "claim")
    if not sentences and any(not cell.good.empty for cell in arrangement.cells):
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
        tuple(sentences), (*failures, *_failed_runs(record, arrangement)), tuple(_warnings(record, arrangement))
    )


def stability(arrangement: Arrangement) -> str:
    """ "stable" where nine points in ten have medians known to 5 %, "noisy" where not, "" where it cannot be said."""
    judged = [
        summary.stable
        for cell in arrangement.cells
        for metric in arrangement.metrics
        if is_clock(metric) and (summary := cell.summary(metric)) is not None and summary.stable is not None
    ]
    if not judged:
        return ""
    return "stable" if sum(judged) >= STABLE_SHARE * len(judged) else "noisy"


def _fastest(arrangement: Arrangement) -> list[Markup]:
    """Who is ahead at either end of x, in every panel."""
    found = []
    methods = arrangement.methods
    xs = arrangement.x_values or (None,)
    many = len(arrangement.panels) > 2
    # the far end first: that is where methods part
    ends = xs[:4] if not arrangement.numeric else (xs[-1:] if many or len(xs) == 1 else (xs[-1], xs[0]))
    metrics = [metric for metric in arrangement.metrics if is_clock(metric)][: 1 if many else 2]
    for metric in metrics:
        for panel in arrangement.panels:
            lines = [series for series in methods if series.panel == panel]
            for x in ends if methods is arrangement.series else (None,):
                ranked = rank(lines, x, metric, arrangement.floor(metric))
                if len(ranked) > 1:
                    found.append(_lead(arrangement, ranked, panel, x, metric))
    return found


def _lead(arrangement: Arrangement, ranked: Sequence[Ranked], panel: str, x: object, metric: str) -> Markup:
    best, level = ranked[0], [entry for entry in ranked if entry.level]
    where = Markup("For {}: ").format(_scene(arrangement, best.cell, panel, x))
    most = "highest" if more_is_better(metric) else "lowest"
    value = quantity(best.median, metric_unit(metric))
    if len(level) > 1:
        names = " and ".join(entry.series.label for entry in level)
        rank_text = "about" if len(level) == len(ranked) else f"the {most}, about"
        text = Markup("{}{} cannot be told apart in {}, {} <strong>{}</strong>").format(
            where, names, metric_title(metric), rank_text, value
        )
    else:
        text = Markup("{}<strong>{}</strong> has the {} {}, <strong>{}</strong>").format(
            where, best.series.label, most, metric_title(metric), value
        )
    behind = [entry for entry in ranked if not entry.level and entry.behind is not None]
    if behind:
        chosen = dict.fromkeys((behind[0].series.label, behind[-1].series.label))
        said = [entry for entry in behind if entry.series.label in chosen]
        parts = [
            Markup("{} ahead of {}").format(_times(entry.behind), entry.series.label)
            for entry in said
            if entry.behind is not None
        ]
        text += Markup("; that is ") + Markup(", ").join(parts)
    return text + Markup(".")


def _scene(arrangement: Arrangement, cell: Cell, panel: str, x: object) -> str:
    """The scene of a point, and what else of it is swept."""
    parts = [scene_text(cell.point.parameters)]
    if arrangement.x and x is not None and arrangement.x not in SCENE_LEAVES:
        parts.append(setting(arrangement.x, x))
    if panel and arrangement.panel_leaf not in SCENE_LEAVES:
        parts.append(panel)
    return ", ".join(parts)


def _change(arrangement: Arrangement) -> list[Markup]:
    """How far a lone series' metrics change from one end of x to the other."""
    if len(arrangement.series) != 1 or not arrangement.numeric or len(arrangement.x_values) < 2:
        return []
    series, found = arrangement.series[0], []
    for metric in arrangement.metrics:
        seen = [(cell, x) for cell, x in zip(series.cells, series.x, strict=True) if cell.summary(metric)]
        if len(seen) < 2:
            continue
        (first, low), (last, high) = seen[0], seen[-1]
        ratio = times_worse(last, first, metric)
        if ratio is None or not math.isfinite(ratio.median):
            continue
        if more_is_better(metric) and ratio.median > 0:
            ratio = Summary(1 / ratio.median, 1 / ratio.high, 1 / ratio.low, ratio.coverage, ratio.n)
        text = Markup("From {} to {}, {} goes from {} to <strong>{}</strong>").format(
            setting(str(arrangement.x), low),
            setting(str(arrangement.x), high),
            metric_title(metric),
            quantity(first.median(metric), metric_unit(metric)),
            quantity(last.median(metric), metric_unit(metric)),
        )
        how = _times(ratio)
        apart = told_apart(ratio, arrangement.floor(metric) if is_clock(metric) else 0.0)
        told = Markup("") if apart else Markup(", not to be told from no change")
        found.append(text + Markup(": {}{}.").format(how, told))
    return found


def _exponents(arrangement: Arrangement, growths: Sequence[Growth]) -> list[Markup]:
    """Growth in one sentence: of all metrics of a lone series, or of all series in the first metric."""
    lone = len(arrangement.series) == 1
    wanted = arrangement.metrics if lone else arrangement.metrics[:1]
    said: dict[str, list[Growth]] = {}
    for growth in growths:
        # a slope known no better than that says nothing in a sentence; the table has it
        told = growth.exponent.enough and not growth.exponent.high - growth.exponent.low > _WIDEST
        if told and growth.metric in wanted:
            said.setdefault(metric_title(growth.metric) if lone else growth.series.label, []).append(growth)
    if not said or len(said) > _MOST_EXPONENTS or (lone and metric_title(wanted[0]) not in said):
        return []
    parts = [
        Markup("{} as {}<sup><strong>{}</strong></sup>{}").format(name, arrangement.x, *_exponent(group))
        for name, group in said.items()
    ]
    subject = "Growth" if lone else f"Growth of {metric_title(wanted[0])}"
    over = f" over all values of {arrangement.panel_leaf}" if arrangement.panel_leaf else ""
    confidence = f"{CONFIDENCE * 100:.0f} %"
    head = Markup("{} with {}{}, in brackets its {} interval: ").format(subject, arrangement.x, over, confidence)
    return [head + Markup(", ").join(parts) + Markup(".")]


def _exponent(group: Sequence[Growth]) -> tuple[str, str]:
    """The exponent and its interval; of several panels what spans them all."""
    values = [growth.exponent.value for growth in group]
    low, high = min(growth.exponent.low for growth in group), max(growth.exponent.high for growth in group)
    ends = list(dict.fromkeys((exponent_text(min(values)), exponent_text(max(values)))))
    return "…".join(ends), f" [{exponent_text(low)}, {exponent_text(high)}]" if math.isfinite(low) else ""


def _outcomes(verdicts: Sequence[VerdictRow], noun: str) -> list[Markup]:
    if not verdicts:
        return []
    counts = Counter(row.verdict for row in verdicts)
    said = ", ".join(
        f"{number(counts[word])} {word if counts[word] == 1 else more}" for word, more in _WORDS if counts[word]
    )
    held = Markup("{}: <strong>{}</strong>.").format(f"{noun}s".capitalize(), said)
    false = [Markup("False: {}").format(_ended(row.statement)) for row in verdicts if row.verdict == "fails"]
    return [held, *false]


_WORDS = (("holds", "hold"), ("fails", "fail"), ("undecided", "undecided"))


def _single(arrangement: Arrangement) -> list[Markup]:
    """The plain numbers, where there is nothing to compare."""
    cell = next(cell for cell in arrangement.cells if not cell.good.empty)
    metrics = [*arrangement.metrics, "run_seconds", "frames_per_second", "events"]
    parts = [
        Markup("{} <strong>{}</strong>").format(
            metric_title(metric), quantity(cell.median(metric), metric_unit(metric))
        )
        for metric in dict.fromkeys(metrics)
        if cell.summary(metric)
    ]
    return [Markup("{}.").format(Markup(", ").join(parts))] if parts else []


def _failed_runs(record: ExperimentRecord, arrangement: Arrangement) -> list[Markup]:
    ended = Counter(str(status) for cell in arrangement.cells for status in cell.runs["status"])
    refused = sum(refusals(record, cell.runs) for cell in arrangement.cells)
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


def _warnings(record: ExperimentRecord, arrangement: Arrangement) -> list[Markup]:
    found = []
    said: dict[str, list[Cell]] = {}
    for cell in arrangement.cells:
        for text in dict.fromkeys(cell.point.plan.get("warnings") or ()):
            said.setdefault(str(text), []).append(cell)
    for text, cells in said.items():
        whole = len(cells) == len(arrangement.cells)
        whom = "every point" if whole else f"{number(len(cells))} of {plural(len(arrangement.cells), 'point')}"
        found.append(Markup("<strong>{}</strong> ({}).").format(_capital(text.rstrip(".")), whom))
    disagreeing = [cell for cell in arrangement.cells if cell.disagrees]
    if disagreeing:
        found.append(
            Markup(
                "<strong>{} hits that the reference does not, or misses some</strong>: struck through, never ranked."
            ).format(f"{plural(len(disagreeing), 'point')} {'reports' if len(disagreeing) == 1 else 'report'}")
        )
    escaped = [cell for cell in arrangement.cells if (cell.values("escaped") > 0).any()]
    if escaped:
        found.append(Markup("<strong>Bodies left the box</strong> in {}.").format(plural(len(escaped), "point")))
    if any("timing_grade" in cell.good and not cell.good["timing_grade"].all() for cell in arrangement.cells):
        found.append(
            Markup(
                "<strong>Some runs are not timing-grade</strong>: they shared a machine with other runs. "
                "Counts are exact, times are not."
            )
        )
    asked = arrangement.metrics if (record.specification.get("report") or {}).get("y") else ()
    unreported = [name for name in asked if not any(len(cell.values(name)) for cell in arrangement.cells)]
    if unreported and any(not cell.good.empty for cell in arrangement.cells):
        found.append(Markup("No run reports {}, which the experiment asks for.").format(", ".join(unreported)))
    where = {machine for cell in arrangement.cells for machine in cell.runs["machine"]}
    if len(where) > 1:
        found.append(
            Markup("<strong>Runs come from {} machines</strong>: times compare only within one.").format(len(where))
        )
    busy = [cell for cell in arrangement.cells if elapsed_ratio(cell) > SLOW_ELAPSED]
    if busy:
        found.append(
            Markup(
                "The machine was busy: elapsed time is more than {} times the CPU time in {} of {}. "
                "CPU time leads on this page."
            ).format(f"{SLOW_ELAPSED:g}", number(len(busy)), plural(len(arrangement.cells), "point"))
        )
    if stability(arrangement) == "noisy":
        found.append(
            Markup("Noisy: fewer than nine in ten medians are known to {}.").format(f"±{NOISY_ABOVE * 100:.0f} %")
        )
    return found


def _times(ratio: Summary) -> Markup:
    """A ratio with its interval in brackets; a range, where it is only that, says so, and one pair has neither."""
    text = Markup("<strong>{}×</strong>").format(number(ratio.median))
    if ratio.n < 2:
        return text
    kind = "" if ratio.coverage is not None else " (range)"
    return text + Markup(" [{}, {}]{}").format(number(ratio.low), number(ratio.high), kind)


def _full(series: Series) -> str:
    return f"{series.label}, {series.panel}" if series.panel else series.label


def _ended(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
