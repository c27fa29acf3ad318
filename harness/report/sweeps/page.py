"""What the page of differences says of two sweeps: the newest, and the one before it that measured the same points."""

from __future__ import annotations

import math
from pathlib import Path

from markupsafe import Markup

from harness.errors import InputError
from harness.measure.statistics import FEWEST_FOR_INTERVAL
from harness.report.quantity import Scale, number, plural, scale
from harness.report.sweeps.difference import CLOCK, MOST_DRIFT, Difference, PointDifference, difference
from harness.report.table import Column, Entry, Table, plain, words
from harness.report.words import metric_title
from harness.store.records import SweepRecord

_MOST_ROWS = 300
_WORDS = {"slower": "slower", "faster": "faster", "same": "not to be told apart", "unknown": "too little to tell"}


def newest_difference(database: str | Path) -> Difference | None:
    """What the page shows; None where no two sweeps measured the same points."""
    try:
        return difference(database)
    except InputError:
        return None


def points_table(found: Difference) -> Table:
    """Every point that both sweeps measured, those that differ first."""
    unit = scale([point.before for point in found.points], "s")
    rows = tuple(_row(point, unit) for point in found.points[:_MOST_ROWS])
    note = (
        f"{metric_title(CLOCK).capitalize()} in CPU {unit.symbol}, medians; the ratio after / before is paired repeat "
        f"by repeat{', without what all points have in common' if found.drift is not None else ''}. It is called "
        f"slower or faster where, of {FEWEST_FOR_INTERVAL} pairs or more, its whole interval lies more than "
        f"{100 * found.floor:.0f} % from 1, and all points looked at together let its p-value count."
    )
    if len(found.points) > _MOST_ROWS:
        note += f" The first {_MOST_ROWS} of {plural(len(found.points), 'point')}; `harness diff` has all."
    columns = (
        Column("Experiment", numeric=False), Column("Point", numeric=False), Column("before", unit.symbol),
        Column("after", unit.symbol), Column("ratio"), Column("interval"), Column("time", numeric=False),
        Column("changed", numeric=False),
    )  # fmt: skip
    return Table("Points measured by both", note, columns, rows)


def summary(found: Difference) -> list[Markup]:
    """What differs, in sentences."""
    counts = found.counts
    if not counts["slower"] and not counts["faster"]:
        paces = Markup("No point got slower or faster")
    else:
        paces = Markup("<strong>{}</strong> got slower, <strong>{}</strong> faster").format(
            plural(counts["slower"], "point"), number(counts["faster"])
        )
    sentences = [paces + Markup(" by more than {:.0f} %, of {}.").format(100 * found.floor, _points(len(found.points)))]
    if found.drift is not None:
        sentences.append(
            Markup(
                "All of them together took <strong>{} times</strong> as long: up to a factor of {} that is taken for a "
                "drift of the machine, and taken out of every ratio."
            ).format(number(found.drift), number(MOST_DRIFT))
        )
    if counts["unknown"]:
        sentences.append(Markup("{} without enough repeats to tell.").format(_points(counts["unknown"])))
    if counts["changed"]:
        sentences.append(Markup("<strong>{}</strong> counted or ended otherwise.").format(_points(counts["changed"])))
    else:
        sentences.append(Markup("All of them counted the same, and ended the same way."))
    if found.untouched:
        sentences.append(Markup("{} not measured again.").format(_points(found.untouched)))
    return sentences


def facts(sweep: SweepRecord) -> list[tuple[str, str]]:
    """A sweep, for people."""
    return [
        ("sweep", f"{sweep.id}, {sweep.started} – {sweep.finished or 'not finished'}"),
        ("command", sweep.command),
        ("harness", f"{sweep.version}, commit {sweep.commit or 'unknown'}"),
    ]


def _row(point: PointDifference, unit: Scale) -> tuple[Entry, ...]:
    ratio = point.ratio
    known = ratio.n > 0 and math.isfinite(ratio.median)
    kind = "" if ratio.coverage is not None else " (range)"
    interval = f"{number(ratio.low)} to {number(ratio.high)}{kind}" if known and ratio.n > 1 else "–"
    differing = [f"{name} {number(before)} → {number(after)}" for name, (before, after) in point.counters.items()]
    if point.statuses is not None:
        differing.append(f"{point.statuses[0]} → {point.statuses[1]}")
    pace = _WORDS[point.pace]
    return (
        words(point.experiment),
        Entry(point.label or "the only one", numeric=False, mark="long"),
        Entry(unit.text(point.before), sort=plain(point.before)),
        Entry(unit.text(point.after), sort=plain(point.after)),
        Entry(f"{number(ratio.median)}×" if known else "–", sort=plain(ratio.median)),
        Entry(interval, sort=plain(ratio.low)),
        words("", flag=pace) if point.pace == "slower" else words(pace),
        words("", flag="; ".join(differing)) if differing else words("–"),
    )


def _points(count: int) -> str:
    return plural(count, "point")
