"""What the tables of an experiment's points share: what a point is called, and what its numbers are."""

from __future__ import annotations

from harness.report.point import MeasuredPoint
from harness.report.quantity import leaf_text
from harness.report.series import Arrangement, Series, in_a_panel
from harness.report.table import Column, Entry, plain
from harness.report.words import capital, leaf_label, metric_title


def place_of(arrangement: Arrangement, series: Series, x: object) -> str:
    """A point in words: its series, its panel and its x."""
    parts = [series.label] if len(arrangement.series) > 1 else []
    parts += [series.panel] if series.panel else []
    parts += [leaf_label(arrangement.x, x)] if arrangement.x else []
    return ", ".join(parts) or series.label


def panel_column(arrangement: Arrangement) -> list[Column]:
    """The column of the leaf that tells panels apart, where there is one."""
    return [Column(arrangement.panel_leaf, numeric=False)] if arrangement.panel_leaf else []


def panel_entry(arrangement: Arrangement, point: MeasuredPoint) -> list[Entry]:
    """Its value at a point."""
    if arrangement.panel_leaf is None:
        return []
    value = in_a_panel(arrangement.panel_leaf, point.parameters.get(arrangement.panel_leaf))
    return [Entry(leaf_text(value), numeric=False, mark="keep", sort=plain(value))]


def heading(metric: str) -> str:
    """A metric as the heading of a column."""
    return capital(metric_title(metric))


def medians_text(arrangement: Arrangement) -> str:
    """What the numbers are, and what their intervals really cover."""
    summaries = [
        summary
        for point in arrangement.points
        for metric in (*arrangement.metrics, "run_seconds")
        if (summary := point.summary(metric)) is not None
    ]
    known = sorted(summary.coverage for summary in summaries if summary.coverage is not None)
    if known:
        low, high = f"{100 * known[0]:.0f}", f"{100 * known[-1]:.0f}"
        return (
            f"median ± half its interval ({low} %)" if low == high else f"median ± half its interval ({low}–{high} %)"
        )
    if any(summary.n > 1 for summary in summaries):
        return "median ± half its range (too few repeats for an interval)"
    return "one run a point, so no interval"
