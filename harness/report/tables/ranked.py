"""Method against method: a table a metric, with the best of each panel bold. None where there is only one of them."""

from __future__ import annotations

from harness.report.quantity import scale
from harness.report.ranking import Ranked, rank, unranked
from harness.report.series import Arrangement
from harness.report.table import Column, Table, measured, words
from harness.report.tables.naming import heading, medians_text, panel_column, panel_entry
from harness.report.words import is_ranked, leaf_label, metric_unit

# times worse than the best, from which each tint begins
_TINTS = ((100.0, "t5"), (20.0, "t4"), (5.0, "t3"), (2.0, "t2"), (1.2, "t1"))


def ranked_tables(arrangement: Arrangement) -> list[Table]:
    """The tables of an experiment, series down and x across; or methods down where one series runs over them."""
    if len(arrangement.methods) < 2:
        return []
    measured_ones = [
        metric
        for metric in arrangement.metrics
        if any((point.values(metric) != 0.0).any() for point in arrangement.points)
    ]
    return [_table(arrangement, metric) for metric in measured_ones]


def _table(arrangement: Arrangement, metric: str) -> Table:
    methods = arrangement.methods
    across = arrangement.x is not None and methods is arrangement.series
    xs = arrangement.x_values if across else (None,)
    unit = scale([point.median(metric) for point in arrangement.points], metric_unit(metric))
    ranked, resolution, rows = is_ranked(metric), arrangement.resolution(metric), []
    reasons: dict[str, None] = {}  # why columns are not ranked
    for panel in arrangement.panels:
        lines = [series for series in methods if series.panel == panel]
        ranks = [
            {entry.series.label: entry for entry in rank(lines, x, metric, resolution)} if ranked else {} for x in xs
        ]
        why_not = [unranked(entry.distinction for entry in places.values()) for places in ranks]
        reasons |= dict.fromkeys(filter(None, why_not))
        ranks = [{} if reason else places for places, reason in zip(ranks, why_not, strict=True)]
        for series in lines:
            row = [words(series.label, series.style), *panel_entry(arrangement, series.points[0])]
            row += [
                measured(series.at(x) if across else series.points[0], metric, unit, _mark(places.get(series.label)))
                for x, places in zip(xs, ranks, strict=True)
            ]
            rows.append(tuple(row))
    columns = [Column("Series", numeric=False), *panel_column(arrangement)]
    if across:
        columns += [Column(leaf_label(str(arrangement.x), x)) for x in xs]
    else:
        columns.append(Column(metric, unit.symbol))
    units = f", {unit.symbol}" if unit.symbol else ""
    note = f"{metric}{units}, {medians_text(arrangement)}."
    if ranked:
        note += " Bold: best, or not to be told from it. Tint: times worse than the best."
    if reasons:
        note += f" Without either: {', or '.join(reasons)}."
    if any(point.disputed for point in arrangement.points):
        note += " Not ranked: methods that saw different hits of the same motion."
    apart = [series.label for series in methods if any(point.replaces_shape for point in series.points)]
    if ranked and 0 < len(set(apart)) < len({series.label for series in methods}):
        names = " and ".join(dict.fromkeys(apart))
        note += f" Not ranked where others are: {names}, for another shape in place of that of the bodies."
    if any(point.is_wrong for point in arrangement.points):
        note += f" Struck through: {_why_struck(arrangement)}, and is not ranked."
    return Table(heading(metric), note, tuple(columns), tuple(rows))


def _why_struck(arrangement: Arrangement) -> str:
    ways = (("disagrees with the reference", "disagrees"), ("was proven wrong by comparison", "proven_wrong"))
    return " or ".join(text for text, how in ways if any(getattr(point, how) for point in arrangement.points))


def _mark(entry: Ranked | None) -> str:
    if entry is None or entry.tied:
        return "best" if entry else ""
    times = entry.ratio.median if entry.ratio else 1.0
    return next((name for from_, name in _TINTS if times >= from_), "")
