"""Every point of an experiment with what it measured: tests, clocks, and all the rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.measure.metrics import METRICS
from harness.report.point import BUSY_ABOVE, MeasuredPoint
from harness.report.quantity import leaf_text, number, scale
from harness.report.series import Arrangement
from harness.report.table import Column, Entry, Table, measured, plain, words
from harness.report.tables.naming import heading, medians_text, panel_column, panel_entry
from harness.report.words import capital, leaf_title, metric_unit

# The homework's columns, in its order.
_TESTS = (
    "frames", "frames_per_second", "pair_tests", "pair_seconds_per_frame", "box_tests", "box_seconds_per_frame",
)  # fmt: skip
_CLOCKS = tuple(name for name, metric in METRICS.items() if metric.clock and metric.tabulated)
_OTHERS = tuple(
    name for name, metric in METRICS.items() if metric.tabulated and not metric.clock and name not in _TESTS
)
_MEMORY = ("run_seconds", "copy_bandwidth", "frame_bytes_per_body", "times_of_memory")
_MOST_ROWS = 100


def tests_table(arrangement: Arrangement) -> Table | None:
    """Tests and their times, as the homework tabulates them."""
    how = medians_text(arrangement)
    note = f"{capital(how)}. Counts are exact. Times are CPU time."
    return _points_table(arrangement, "Tests and times", note, _TESTS)


def clocks_table(arrangement: Arrangement) -> Table | None:
    """CPU seconds of every phase, with the elapsed time of the run beside it."""
    note = (
        f"CPU seconds of each phase of a whole run, {medians_text(arrangement)}; beside them the elapsed time of the "
        f"run. Elapsed over CPU above {BUSY_ABOVE:g} is flagged: the machine was busy with something else."
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


def memory_table(arrangement: Arrangement) -> Table | None:
    """Frames beside the time that their least traffic of memory takes, where an experiment asks for it."""
    if not any(point.summary("times_of_memory") for point in arrangement.points):
        return None
    note = (
        "A frame that places every body reads its place and velocity and writes its place, of turning bodies their "
        "orientation and spin too. Times of memory: how many times as long a frame takes as a plain copy, on one core "
        f"after the same run, needs for as many bytes; {medians_text(arrangement)}."
    )
    return _points_table(arrangement, "How far from memory", note, _MEMORY)


def _points_table(arrangement: Arrangement, name: str, note: str, metrics: Sequence[str]) -> Table | None:
    points = arrangement.points
    shown = [metric for metric in metrics if any(point.summary(metric) for point in points)]
    if not shown:
        return None
    units = {metric: scale([point.median(metric) for point in points], metric_unit(metric)) for metric in shown}
    several, x = len(arrangement.series) > 1, arrangement.x
    columns = [Column("Series", numeric=False)] if several or x is None else []
    columns += panel_column(arrangement)
    columns += [Column(leaf_title(x), numeric=arrangement.numeric)] if x else []
    columns += [Column(heading(metric), units[metric].symbol) for metric in shown]
    rows = []
    for series in arrangement.series:
        for point, value in zip(series.points, series.x, strict=True):
            row = [words(series.label, series.style)] if several or x is None else []
            row += panel_entry(arrangement, point)
            row += [_x_entry(value, arrangement.numeric)] if x else []
            row += [measured(point, metric, units[metric]) for metric in shown]
            rows.append(tuple(row))
    left = len(rows) - _MOST_ROWS
    if left > 0:
        note += f" The first {_MOST_ROWS} points; {number(left)} more are in the table of all points."
    return Table(name, note, tuple(columns), tuple(rows[:_MOST_ROWS]))


def _x_entry(value: object, numeric: bool) -> Entry:
    return Entry(leaf_text(value), numeric=numeric, sort=plain(value))


def _elapsed(point: MeasuredPoint) -> Entry:
    ratio = point.elapsed_ratio
    if math.isnan(ratio):
        return Entry("–")
    return Entry(f"{ratio:.2f}", flag="busy" if ratio > BUSY_ABOVE else "", sort=plain(ratio))
