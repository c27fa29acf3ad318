"""Published rows beside ours, and what their counts imply."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.report.published import PublishedRow, Recovered, metrics_of
from harness.report.quantity import number, scale
from harness.report.table import Column, ColumnGroup, Entry, Table, counted, failure, plain, words
from harness.report.words import metric_title, metric_unit


def published_table(rows: Sequence[PublishedRow], source: str) -> Table:
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
    groups = [ColumnGroup("", len(columns))]
    for metric in metrics:
        columns += [Column("theirs", units[metric].symbol), Column("ours", units[metric].symbol), Column("ratio")]
        groups.append(ColumnGroup(metric_title(metric), 3))
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
