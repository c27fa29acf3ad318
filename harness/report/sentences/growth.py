"""How metrics change over x: exponents, and from one end to the other."""

from __future__ import annotations

import math
from collections.abc import Sequence

from markupsafe import Markup

from harness.measure.resolution import Distinction
from harness.measure.statistics import CONFIDENCE, FEWEST_FOR_INTERVAL, Summary
from harness.report.point import MeasuredPoint
from harness.report.quantity import exponent_text, quantity
from harness.report.ranking import Growth, change_p_value, tell_apart, times_worse
from harness.report.sentences.ratio import ratio_text
from harness.report.series import Arrangement
from harness.report.words import leaf_label, metric_title, metric_unit, more_is_better

_MOST_EXPONENTS = 8
_WIDEST = 2.0
_DOUBTS = {
    "apart": "",
    "same": ", not to be told from no change",
    "few": f", too few repeats to tell from no change (fewer than {FEWEST_FOR_INTERVAL})",
}


def exponent_sentences(arrangement: Arrangement, growths: Sequence[Growth]) -> list[Markup]:
    """Growth in one sentence: of all metrics of a lone series, or of all series in the first metric."""
    lone = len(arrangement.series) == 1
    wanted = arrangement.metrics if lone else arrangement.metrics[:1]
    growths_of: dict[str, list[Growth]] = {}
    for growth in growths:
        # a slope known no better than that says nothing in a sentence; the table has it
        is_known = growth.exponent.enough and not growth.exponent.high - growth.exponent.low > _WIDEST
        if is_known and growth.metric in wanted:
            growths_of.setdefault(metric_title(growth.metric) if lone else growth.series.label, []).append(growth)
    if not growths_of or len(growths_of) > _MOST_EXPONENTS or (lone and metric_title(wanted[0]) not in growths_of):
        return []
    parts = [
        Markup("{} as {}<sup><strong>{}</strong></sup>{}").format(name, arrangement.x, *_exponent(group))
        for name, group in growths_of.items()
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


def change_sentences(arrangement: Arrangement) -> list[Markup]:
    """How far a lone series' metrics change from one end of x to the other."""
    if len(arrangement.series) != 1 or not arrangement.numeric or len(arrangement.x_values) < 2:
        return []
    series, found = arrangement.series[0], []
    for metric in arrangement.metrics:
        seen = [(point, x) for point, x in zip(series.points, series.x, strict=True) if point.summary(metric)]
        if len(seen) < 2:
            continue
        (first, low), (last, high) = seen[0], seen[-1]
        ratio = times_worse(last, first, metric)
        if ratio is None or not math.isfinite(ratio.median):
            continue
        if more_is_better(metric) and ratio.median > 0:
            ratio = Summary(1 / ratio.median, 1 / ratio.high, 1 / ratio.low, ratio.coverage, ratio.n)
        text = Markup("From {} to {}, {} goes from {} to <strong>{}</strong>").format(
            leaf_label(str(arrangement.x), low),
            leaf_label(str(arrangement.x), high),
            metric_title(metric),
            quantity(first.median(metric), metric_unit(metric)),
            quantity(last.median(metric), metric_unit(metric)),
        )
        how = ratio_text(ratio)
        doubt = _DOUBTS[_distinction(last, first, metric, arrangement)]
        found.append(text + Markup(": {}{}.").format(how, doubt))
    return found


def _distinction(last: MeasuredPoint, first: MeasuredPoint, metric: str, arrangement: Arrangement) -> Distinction:
    """Whether a change is told from none."""
    found = tell_apart(last, first, metric, arrangement.resolution(metric))
    if found != "uncontrolled":
        return found
    return "apart" if change_p_value(last, first, metric) <= arrangement.level else "same"
