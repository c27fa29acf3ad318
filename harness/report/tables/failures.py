"""Runs that did not come to their end."""

from __future__ import annotations

from harness.report.series import Arrangement
from harness.report.table import Column, Entry, Table, words
from harness.report.tables.naming import place_of


def failures_table(arrangement: Arrangement) -> Table | None:
    """Every run that did not come to its end, with its reason; equal ones of a point together."""
    rows = []
    for series in arrangement.series:
        for point, x in zip(series.points, series.x, strict=True):
            ended_otherwise = point.runs["status"] != "ok"
            if not ended_otherwise.any():
                continue
            bad = point.runs.loc[ended_otherwise, ["status", "reason", "repeat"]]
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
