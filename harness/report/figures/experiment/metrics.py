"""Every metric that an experiment asks for, against its x: one figure a metric.

Where there is only one series to tell apart, all metrics of a unit share a figure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.report.drawing.panels import Line, Panel, draw_panels
from harness.report.experiment import ExperimentPage
from harness.report.figure import Figure, FigureSource, Key
from harness.report.lines import axis_title, in_words, median_text, spans_logarithms, spans_wide
from harness.report.quantity import Scale, leaf_text, scale
from harness.report.series import Arrangement, Series
from harness.report.words import capital, is_noisy, leaf_label, leaf_title, metric_title, metric_unit

_MOST_PANELS = 8


def _figures(page: ExperimentPage) -> list[Figure]:
    arrangement = page.arrangement
    if arrangement.x is None or len(arrangement.x_values) < 2:
        return []
    metrics = [metric for metric in arrangement.metrics if _measured(arrangement, metric)]
    if len(arrangement.series) > 1:
        return [_figure(arrangement, (metric,)) for metric in metrics]
    units = dict.fromkeys(map(metric_unit, metrics))
    return [_figure(arrangement, tuple(m for m in metrics if metric_unit(m) == unit)) for unit in units]


def _figure(arrangement: Arrangement, metrics: tuple[str, ...]) -> Figure:
    unit = scale([point.median(metric) for point in arrangement.points for metric in metrics], metric_unit(metrics[0]))
    filled = [
        name for name in arrangement.panels if any(_reported(s, metrics) for s in arrangement.series if s.panel == name)
    ]
    names = filled[:_MOST_PANELS]
    by_metric = len(metrics) > 1
    panels = []
    for name in names:
        inside = [series for series in arrangement.series if series.panel == name]
        lines = (
            [replace(_line(inside[0], metric, unit, arrangement), label=metric, style=place)
             for place, metric in enumerate(metrics)]
            if by_metric
            else [_line(series, metrics[0], unit, arrangement) for series in inside]
        )  # fmt: skip
        panels.append(_panel(arrangement, name, metrics, lines, unit))
    logarithmic = all(spans_logarithms(panel) for panel in panels) and not panels[0].categories
    wide = all(map(spans_wide, panels)) and not panels[0].categories
    panels = [replace(panel, logarithmic=logarithmic, logarithmic_x=wide) for panel in panels]
    title = capital(" and ".join(map(metric_title, metrics)))
    assert arrangement.x is not None
    over = leaf_title(arrangement.x)
    kind = "Log-log plot" if logarithmic else "Plot"
    keys = {line.label: Key(line.label, line.style) for panel in panels for line in panel.lines}
    left = len(filled) - len(names)
    return Figure(
        "-".join(metrics),
        f"{title} against {over}",
        f"{kind} of {title.lower()} against {over}. {' '.join(map(in_words, panels))}",
        _caption(arrangement, metrics, logarithmic, wide)
        + (f" {left} more panels are in the table only." if left else ""),
        lambda form, name: draw_panels(panels if form != "card" else panels[:1], form, name),
        tuple(keys.values()),
        labelled=True,
    )


def _panel(arrangement: Arrangement, name: str, metrics: Sequence[str], lines: Sequence[Line], unit: Scale) -> Panel:
    assert arrangement.x is not None
    categories = () if arrangement.numeric else tuple(map(leaf_text, arrangement.x_values))
    label = axis_title(metrics[0], unit) if len(metrics) == 1 else unit.symbol
    over = leaf_title(arrangement.x)
    x_label = over if over == arrangement.x else f"{over} ({arrangement.x})"
    return Panel(name, x_label, label, tuple(lines), categories, x_text=leaf_text)


def _line(series: Series, metric: str, unit: Scale, arrangement: Arrangement) -> Line:
    x, y, low, high, texts = [], [], [], [], []
    for point, value in zip(series.points, series.x, strict=True):
        found = point.summary(metric)
        if found is None:
            continue
        x.append(float(value) if arrangement.numeric else float(arrangement.x_values.index(value)))
        y.append(found.median / unit.factor)
        low.append(found.low / unit.factor)
        high.append(found.high / unit.factor)
        texts.append(f"{series.label}, {_place(arrangement, value)}: {median_text(found, unit)}")
    return Line(series.label, series.style, tuple(x), tuple(y), tuple(low), tuple(high), texts=tuple(texts))


def _place(arrangement: Arrangement, value: object) -> str:
    return leaf_label(str(arrangement.x), value)


def _measured(arrangement: Arrangement, metric: str) -> bool:
    return any(_reported(series, (metric,)) for series in arrangement.series)


def _reported(series: Series, metrics: Sequence[str]) -> bool:
    """Whether a point of it has one of the metrics: what is asked of some points has nothing to draw for others."""
    return any(point.summary(metric) for point in series.points for metric in metrics)


def _caption(arrangement: Arrangement, metrics: Sequence[str], logarithmic: bool, wide: bool) -> str:
    sentences = []
    shape = "band" if arrangement.numeric else "bar"
    if any(map(is_noisy, metrics)):
        found = [point.summary(metric) for point in arrangement.points for metric in metrics]
        counts = [summary.n for summary in found if summary]
        if max(counts) == 1:
            sentences.append("One run a point: no interval.")
        elif all(summary.coverage is None for summary in found if summary):
            sentences.append(f"Medians; the {shape} is the range of the repeats, too few for an interval.")
        else:
            sentences.append(f"Medians; the {shape} is the median's interval.")
    else:
        sentences.append("Exact: the same in every repeat.")
    if logarithmic:
        sentences.append("Both axes are logarithmic: a straight line is a power law, and its slope the exponent.")
    elif wide:
        sentences.append("The axis below is logarithmic.")
    elif not arrangement.numeric:
        sentences.append("The dotted line only guides the eye.")
    return " ".join(sentences)


SOURCE = FigureSource(_figures, place=10)
