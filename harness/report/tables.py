"""The tables of an experiment's page, from its arrangement."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.measure.metrics import METRICS
from harness.measure.statistics import CONFIDENCE, ENOUGH_RANGE
from harness.report.published import Recovered, Row, metrics_of
from harness.report.quantity import exponent_text, leaf_text, number, plural, scale
from harness.report.ranking import Growth, Ranked, rank
from harness.report.series import Arrangement, MeasuredPoint, Series
from harness.report.table import Column, Entry, Group, Table, counted, failure, measured, plain, words
from harness.report.words import is_ranked, leaf_title, metric_title, metric_unit, setting

# The homework's columns, in its order.
_TESTS = (
    "frames", "frames_per_second", "pair_tests", "pair_seconds_per_frame", "box_tests", "box_seconds_per_frame",
)  # fmt: skip
_CLOCKS = tuple(name for name, metric in METRICS.items() if metric.clock and metric.tabulated)
_OTHERS = tuple(
    name for name, metric in METRICS.items() if metric.tabulated and not metric.clock and name not in _TESTS
)
_MOST_ROWS = 100
SLOW_ELAPSED = 1.2
# times worse than the best, from which each tint begins
_TINTS = ((100.0, "t5"), (20.0, "t4"), (5.0, "t3"), (2.0, "t2"), (1.2, "t1"))


def comparisons(arrangement: Arrangement) -> list[Table]:
    """A table a metric: series down, x across, the best of each panel bold. None where there is only one series."""
    if len(arrangement.series) < 2:
        return []
    measured_ones = [
        metric for metric in arrangement.metrics if any(point.summary(metric) for point in arrangement.points)
    ]
    return [_comparison(arrangement, metric) for metric in measured_ones]


def tests_table(arrangement: Arrangement) -> Table | None:
    """Tests and their times, as the homework tabulates them."""
    how = _medians(arrangement)
    note = f"{how[:1].upper()}{how[1:]}. Counts are exact. Times are CPU time."
    return _points_table(arrangement, "Tests and times", note, _TESTS)


def clocks_table(arrangement: Arrangement) -> Table | None:
    """CPU seconds of every phase, with the elapsed time of the run beside it."""
    note = (
        f"CPU seconds of each phase of a whole run, {_medians(arrangement)}; beside them the elapsed time of the run. "
        f"Elapsed over CPU above {SLOW_ELAPSED:g} is flagged: the machine "
        "was busy with something else."
    )
    table = _points_table(arrangement, "CPU and elapsed time", note, _CLOCKS)
    if table is None or not any(point.summary("run_seconds_elapsed") for point in arrangement.points):
        return table
    points = arrangement.points[:_MOST_ROWS]
    rows = tuple((*row, _elapsed(point)) for row, point in zip(table.rows, points, strict=True))
    return Table(table.name, table.note, (*table.columns, Column("elapsed / CPU")), rows)


def others_table(arrangement: Arrangement) -> Table | None:
    """Everything else that was counted: hits, errors, memory."""
    return _points_table(arrangement, "Hits, errors and memory", "Medians over the repeats.", _OTHERS)


def elapsed_ratio(point: MeasuredPoint) -> float:
    """Elapsed over CPU time of a point's runs, nan where it is not known."""
    cpu = point.median("run_seconds")
    return point.median("run_seconds_elapsed") / cpu if cpu > 0 else math.nan


def exponents_table(growths: Sequence[Growth], arrangement: Arrangement) -> Table:
    """Exponents with their intervals, or why there are none."""
    several, rows = len(arrangement.series) > 1, []
    metrics = {entry.metric for entry in growths}
    for entry in growths:
        found = entry.exponent
        row = [words(entry.series.label, entry.series.style)] if several else []
        row += _panel_entry(arrangement, entry.series.points[0])
        row += [words(entry.metric)] if len(metrics) > 1 or not several else []
        if found.enough:
            row.append(Entry(exponent_text(found.value), sort=plain(found.value)))
            known = math.isfinite(found.low)
            interval = f"{exponent_text(found.low)} to {exponent_text(found.high)}" if known else "–"
            row.append(Entry(interval, sort=plain(found.low)))
            # rounded down: only an exact power law reads 1.000
            row.append(Entry(f"{math.floor(found.r2 * 1000 + 1e-6) / 1000:.3f}", sort=plain(found.r2)))
        else:
            why = f"not enough range: {number(found.range_factor)}× in x, {plural(found.n, 'value')}"
            row += [Entry("–"), Entry(why, numeric=False), Entry("–")]
        rows.append(tuple(row))
    columns = [Column("Series", numeric=False)] if several else []
    columns += _panel_column(arrangement)
    columns += [Column("Metric", numeric=False)] if len(metrics) > 1 or not several else []
    columns += [Column("b"), Column(f"{CONFIDENCE * 100:.0f} % interval"), Column("R²")]
    subject = metrics.pop() if len(metrics) == 1 else "metric"
    note = (
        f"{subject} ≈ c · {arrangement.x}ᵇ, fitted through the medians. An exponent needs three values of x and a "
        f"factor of {number(ENOUGH_RANGE)} between the outermost."
    )
    return Table("Growth exponents", note, tuple(columns), tuple(rows))


def failures_table(arrangement: Arrangement) -> Table | None:
    """Every run that did not come to its end, with its reason; equal ones of a point together."""
    rows = []
    for series in arrangement.series:
        for point, x in zip(series.points, series.x, strict=True):
            bad = point.runs[point.runs["status"] != "ok"]
            if bad.empty:
                continue
            for (status, reason), group in bad.groupby(["status", "reason"], dropna=False, sort=True):
                text = str(reason) if isinstance(reason, str) and reason else "no reason was recorded"
                repeats = ", ".join(str(int(repeat)) for repeat in sorted(group["repeat"]))
                rows.append(
                    (
                        words(place_of(arrangement, series, x), series.style),
                        words("", flag=str(status)),
                        Entry(text, numeric=False, mark="long"),
                        words(repeats),
                    )
                )
    if not rows:
        return None
    columns = (
        Column("Point", numeric=False),
        Column("Ended", numeric=False),
        Column("Reason", numeric=False),
        Column("Repeats", numeric=False),
    )
    return Table(
        "Runs that failed", "Each is kept as a result of its own; it counts in no median.", columns, tuple(rows)
    )


def published_table(rows: Sequence[Row], source: str) -> Table:
    """Each published number, ours, and ours over theirs."""
    metrics = metrics_of(rows)
    units = {
        metric: scale(
            [value for row in rows for value in (row.numbers.get(metric, 0.0), row.ours(metric))], metric_unit(metric)
        )
        for metric in metrics
    }
    several = len({row.series for row in rows if row.point}) > 1
    columns = [Column("Row", numeric=False)] + ([Column("Ours is", numeric=False)] if several else [])
    groups = [Group("", len(columns))]
    for metric in metrics:
        columns += [Column("theirs", units[metric].symbol), Column("ours", units[metric].symbol), Column("ratio")]
        groups.append(Group(metric_title(metric), 3))
    lines = []
    for row in rows:
        line = [words(row.name)]
        if several:
            line.append(words(row.series or "not measured", row.style if row.point else None))
        for metric in metrics:
            theirs = row.numbers.get(metric)
            ours = row.ours(metric)
            ratio = ours / theirs if theirs else math.nan
            line.append(Entry(units[metric].text(theirs), sort=plain(theirs)))
            line.append(
                Entry(units[metric].text(ours), sort=plain(ours))
                if row.point and not math.isnan(ours)
                else failure(row.point)
            )
            line.append(Entry("–" if math.isnan(ratio) else f"{number(ratio)}×", sort=plain(ratio)))
        lines.append(tuple(line))
    note = f"Theirs: {source}. Ours: medians. Ratio: ours over theirs."
    return Table("Published, beside ours", note, tuple(columns), tuple(lines), tuple(groups))


def recovered_table(found: Sequence[Recovered]) -> Table:
    """The bodies and frames that the published test counts imply, beside those printed."""
    rows = []
    for entry in found:
        whole = number(round(entry.bodies)) if entry.whole else f"{entry.bodies:.2f}"
        rows.append(
            (
                words(entry.row.name),
                counted(entry.row.numbers["pair_tests"]),
                counted(entry.row.numbers["box_tests"]),
                Entry(whole, flag="" if entry.bodies_agree else "≠", sort=plain(entry.bodies)),
                counted(entry.printed) if entry.printed is not None else Entry("–"),
                Entry(number(round(entry.frames, 1)), sort=plain(entry.frames)),
                Entry(
                    number(entry.frames_timed), flag="" if entry.frames_agree else "≠", sort=plain(entry.frames_timed)
                ),
            )
        )
    columns = (
        Column("Row", numeric=False),
        Column("pair tests P"),
        Column("wall tests W"),
        Column("bodies recovered"),
        Column("bodies printed"),
        Column("frames recovered"),
        Column("frames by printed rate"),
    )
    note = (
        "N = 2 P / (W / 6) + 1 bodies and W / (6 N) frames are what the two test counts imply where every pair and "
        "all six walls are tested each frame; frames by the printed rate are frames per second × the simulated time. "
        "≠ marks what contradicts the print."
    )
    return Table("What the published counts imply", note, columns, tuple(rows))


def place_of(arrangement: Arrangement, series: Series, x: object) -> str:
    """A point in words: its series, its panel and its x."""
    parts = [series.label] if len(arrangement.series) > 1 else []
    parts += [series.panel] if series.panel else []
    parts += [setting(arrangement.x, x)] if arrangement.x else []
    return ", ".join(parts) or series.label


def _comparison(arrangement: Arrangement, metric: str) -> Table:
    xs = arrangement.x_values or (None,)
    unit = scale([point.median(metric) for point in arrangement.points], metric_unit(metric))
    ranked, rows = is_ranked(metric), []
    for panel in arrangement.panels:
        lines = [series for series in arrangement.series if series.panel == panel]
        ranks = [
            {entry.series.label: entry for entry in rank(lines, x, metric, arrangement.floor(metric))} if ranked else {}
            for x in xs
        ]
        for series in lines:
            row = [words(series.label, series.style), *_panel_entry(arrangement, series.points[0])]
            row += [
                measured(series.at(x), metric, unit, _mark(places.get(series.label)))
                for x, places in zip(xs, ranks, strict=True)
            ]
            rows.append(tuple(row))
    columns = [Column("Series", numeric=False), *_panel_column(arrangement)]
    if arrangement.x is None:
        columns.append(Column(metric, unit.symbol))
    else:
        columns += [Column(setting(arrangement.x, x)) for x in xs]
    units = f", {unit.symbol}" if unit.symbol else ""
    note = f"{metric}{units}, {_medians(arrangement)}."
    if ranked:
        note += " Bold: best, or not to be told from it. Tint: times worse than the best."
    if any(point.is_wrong for point in arrangement.points):
        note += f" Struck through: {_why_struck(arrangement)}, and is not ranked."
    return Table(_heading(metric), note, tuple(columns), tuple(rows))


def _why_struck(arrangement: Arrangement) -> str:
    ways = (("disagrees with the reference", "disagrees"), ("was proven wrong by comparison", "proven_wrong"))
    return " or ".join(text for text, how in ways if any(getattr(point, how) for point in arrangement.points))


def _panel_column(arrangement: Arrangement) -> list[Column]:
    return [Column(arrangement.panel_leaf, numeric=False)] if arrangement.panel_leaf else []


def _panel_entry(arrangement: Arrangement, point: MeasuredPoint) -> list[Entry]:
    if arrangement.panel_leaf is None:
        return []
    value = point.parameters.get(arrangement.panel_leaf)
    return [Entry(leaf_text(value), numeric=False, mark="keep", sort=plain(value))]


def _mark(entry: Ranked | None) -> str:
    if entry is None or entry.level:
        return "best" if entry else ""
    behind = entry.behind.median if entry.behind else 1.0
    return next((name for from_, name in _TINTS if behind >= from_), "")


def _points_table(arrangement: Arrangement, name: str, note: str, metrics: Sequence[str]) -> Table | None:
    points = arrangement.points
    shown = [metric for metric in metrics if any(point.summary(metric) for point in points)]
    if not shown:
        return None
    units = {metric: scale([point.median(metric) for point in points], metric_unit(metric)) for metric in shown}
    several, x = len(arrangement.series) > 1, arrangement.x
    columns = [Column("Series", numeric=False)] if several or x is None else []
    columns += _panel_column(arrangement)
    columns += [Column(leaf_title(x), numeric=arrangement.numeric)] if x else []
    columns += [Column(_heading(metric), units[metric].symbol) for metric in shown]
    rows = []
    for series in arrangement.series:
        for point, value in zip(series.points, series.x, strict=True):
            row = [words(series.label, series.style)] if several or x is None else []
            row += _panel_entry(arrangement, point)
            row += [_x_entry(value, arrangement.numeric)] if x else []
            row += [measured(point, metric, units[metric]) for metric in shown]
            rows.append(tuple(row))
    left = len(rows) - _MOST_ROWS
    if left > 0:
        note += f" The first {_MOST_ROWS} points; {number(left)} more are in the CSV file."
    return Table(name, note, tuple(columns), tuple(rows[:_MOST_ROWS]))


def _heading(metric: str) -> str:
    title = metric_title(metric)
    return f"{title[:1].upper()}{title[1:]}"


def _x_entry(value: object, numeric: bool) -> Entry:
    return Entry(leaf_text(value), numeric=numeric, sort=plain(value))


def _elapsed(point: MeasuredPoint) -> Entry:
    ratio = elapsed_ratio(point)
    if math.isnan(ratio):
        return Entry("–")
    return Entry(f"{ratio:.2f}", flag="busy" if ratio > SLOW_ELAPSED else "", sort=plain(ratio))


def _medians(arrangement: Arrangement) -> str:
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
