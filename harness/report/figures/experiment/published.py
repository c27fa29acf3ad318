"""The published numbers and ours, a panel a metric, over the leaf that tells the rows apart."""

from __future__ import annotations

import math
from dataclasses import replace

from harness.report.drawing.panels import Line, Panel, draw_panels
from harness.report.experiment import ExperimentPage
from harness.report.figure import Figure, FigureSource, Key
from harness.report.lines import axis_title, in_words, spans_logarithms, spans_wide
from harness.report.published import metrics_of
from harness.report.quantity import Scale, leaf_text, scale
from harness.report.words import leaf_title, metric_title, metric_unit


def _figures(page: ExperimentPage) -> list[Figure]:
    rows = page.published
    if not rows:
        return []
    source = str(page.record.specification["published"].get("source", ""))
    leaves = [leaf for leaf in rows[0].leaves if all(isinstance(row.leaves.get(leaf), int | float) for row in rows)]
    if not leaves or len({row.leaves[leaves[0]] for row in rows}) < 2:
        return []
    leaf, panels = leaves[0], []
    series = {row.series: row.style for row in rows if row.point}
    for metric in metrics_of(rows):
        theirs = {float(row.leaves[leaf]): row.numbers[metric] for row in rows if metric in row.numbers}
        ours = {
            name: {float(row.leaves[leaf]): row.ours(metric) for row in rows if row.series == name and row.point}
            for name in series
        }
        unit = scale(
            [*theirs.values(), *(value for line in ours.values() for value in line.values())], metric_unit(metric)
        )
        lines = [_plain(name, series[name], values, unit) for name, values in ours.items()]
        lines.append(replace(_plain("published", 0, theirs, unit), foreign=True))
        panel = Panel(metric_title(metric), f"{leaf_title(leaf)} ({leaf})", axis_title(metric, unit), tuple(lines))
        panels.append(
            replace(panel, x_text=leaf_text, logarithmic=spans_logarithms(panel), logarithmic_x=spans_wide(panel))
        )
    opening = f"Each panel compares the published numbers of {source} (dashed) with ours, over {leaf_title(leaf)}."
    keys = (*(Key(name, style) for name, style in series.items()), Key("published", 0, foreign=True))
    figure = Figure(
        "published",
        "Published numbers and ours",
        " ".join([opening, *(in_words(panel) for panel in panels)]),
        "Hollow markers and dashed lines: published. Filled: measured here, medians.",
        lambda form, name: draw_panels(panels, form, name, labels=False),
        keys,
        labelled=False,
    )
    return [figure]


def _plain(label: str, style: int, values: dict[float, float], unit: Scale) -> Line:
    seen = {x: y for x, y in sorted(values.items()) if math.isfinite(y)}
    return Line(label, style, tuple(seen), tuple(value / unit.factor for value in seen.values()))


SOURCE = FigureSource(_figures, section="published")
