"""Growth exponents with their intervals, or why there are none."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.measure.statistics import CONFIDENCE, ENOUGH_RANGE
from harness.report.quantity import exponent_text, number, plural
from harness.report.ranking import Growth
from harness.report.series import Arrangement
from harness.report.table import Column, Entry, Table, plain, words
from harness.report.tables.naming import panel_column, panel_entry


def exponents_table(growths: Sequence[Growth], arrangement: Arrangement) -> Table:
    """Exponents with their intervals, or why there are none."""
    several, rows = len(arrangement.series) > 1, []
    metrics = {entry.metric for entry in growths}
    for entry in growths:
        found = entry.exponent
        row = [words(entry.series.label, entry.series.style)] if several else []
        row += panel_entry(arrangement, entry.series.points[0])
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
    columns += panel_column(arrangement)
    columns += [Column("Metric", numeric=False)] if len(metrics) > 1 or not several else []
    columns += [Column("b"), Column(f"{CONFIDENCE * 100:.0f} % interval"), Column("R²")]
    subject = metrics.pop() if len(metrics) == 1 else "metric"
    note = (
        f"{subject} ≈ c · {arrangement.x}ᵇ, fitted through the medians. An exponent needs three values of x and a "
        f"factor of {number(ENOUGH_RANGE)} between the outermost."
    )
    return Table("Growth exponents", note, tuple(columns), tuple(rows))
