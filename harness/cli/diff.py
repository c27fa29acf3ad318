"""Say how two sweeps differ: which points are slower or faster beyond the noise, which counted or ended otherwise.

A point needs five repeats in both sweeps to be called slower or faster, beyond what all points have in common.

Without numbers, the newest sweep and the newest before it that measured the same points; with one, that and the newest.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from harness import DATABASE
from harness.cli.json_document import json_text
from harness.cli.width import say

if TYPE_CHECKING:
    from harness.report.sweeps.difference import Difference, PointDifference


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("before", metavar="SWEEP", nargs="?", type=int, help="number of the earlier sweep")
    parser.add_argument("after", metavar="SWEEP", nargs="?", type=int, help="number of the later sweep")
    parser.add_argument("--db", metavar="FILE", default=DATABASE, help="the database (default: %(default)s)")
    parser.add_argument(
        "--fail-on",
        action="append",
        choices=["slower", "changed"],
        default=[],
        help="exit 1 if a point is slower, or if a counter, a status or a verdict changed; can be given again",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="one JSON document on standard output")
    form.add_argument(
        "--format",
        choices=["text", "markdown"],
        default="text",
        help="markdown: for the comment on a change (default: %(default)s)",
    )


def run(arguments: argparse.Namespace) -> int:
    from harness.report.sweeps.difference import difference

    found = difference(arguments.db, arguments.before, arguments.after)
    if arguments.json:
        print(json_text(_document(found)))
    elif arguments.format == "markdown":
        print(_markdown(found))
    else:
        _say(found)
    failed = ("slower" in arguments.fail_on and found.counts["slower"]) or (
        "changed" in arguments.fail_on and found.changed
    )
    return 1 if failed else 0


def _say(found: Difference) -> None:
    for word, sweep in (("before", found.before), ("after", found.after)):
        say(f"{word:6}  sweep {sweep.id}, {sweep.started}: {sweep.command}")
    for point in found.points:
        told = _told(point)
        if told:
            say(f"{_place(point)}: {'; '.join(told)}")
    for verdict in found.verdicts:
        say(f"{verdict.experiment}: {verdict.before} before, {verdict.after} now: {verdict.statement}")
    for line in _totals(found):
        say(line)


def _totals(found: Difference) -> list[str]:
    """How much differs, and what all points have in common."""
    counts, lines = found.counts, []
    if found.drift is not None:
        lines.append(f"all points together took {found.drift:.3g} times as long: {_drift_text(found.drift)}")
    lines.append(
        f"{len(found.points)} points measured by both: {counts['slower']} slower, {counts['faster']} faster, "
        f"{counts['same']} not to be told apart (by less than {100 * found.floor:.0f} %), "
        f"{counts['unknown']} with too few repeats to tell; {counts['changed']} changed; "
        f"{found.untouched} not measured again"
    )
    return lines


def _markdown(found: Difference) -> str:
    """The same for a page that shows Markdown: what differs as tables, what all of it comes to in a line."""
    before, after = found.before, found.after
    lines = [
        f"**Sweep {before.id}** ({_commit(before.commit)}) against **sweep {after.id}** ({_commit(after.commit)}): "
        f"{found.counts['slower']} slower, {found.counts['faster']} faster, {found.counts['changed']} changed "
        f"of {len(found.points)} points",
        "",
    ]
    paced = [point for point in found.points if point.pace in ("slower", "faster")]
    rows = [
        (
            _place(point),
            f"{point.before:.3g} s",
            f"{point.after:.3g} s",
            f"**{point.ratio.median:.3g}×** [{point.ratio.low:.3g}, {point.ratio.high:.3g}]",
        )
        for point in paced
    ]
    lines += _table(("point", "before", "after", "ratio"), rows)
    changed = [(_place(point), "; ".join(_told(point, pace=False))) for point in found.points if point.changed]
    lines += _table(("point", "changed"), changed)
    judged = [(row.experiment, row.before, row.after, row.statement) for row in found.verdicts]
    lines += _table(("experiment", "before", "now", "statement"), judged)
    return "\n".join([*lines, *(f"- {line}" for line in _totals(found))])


def _table(heading: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A Markdown table; nothing without rows."""
    if not rows:
        return []
    cells = [heading, ["---"] * len(heading), *rows]
    return [*("| " + " | ".join(_cell(cell) for cell in row) + " |" for row in cells), ""]


def _cell(text: str) -> str:
    """Text that can neither end its cell nor become markup of its own."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;").replace("\n", " ")


def _place(point: PointDifference) -> str:
    return f"{point.experiment}{f' ({point.label})' if point.label else ''}"


def _commit(commit: str | None) -> str:
    return f"`{commit[:12]}`" if commit else "no commit"


def _drift_text(drift: float) -> str:
    from harness.report.sweeps.difference import MOST_DRIFT

    if 1.0 / MOST_DRIFT < drift < MOST_DRIFT:
        return "taken for a drift of the machine, and taken out of every ratio"
    return f"more than a machine drifts; {MOST_DRIFT:.3g} times is taken out of every ratio"


def _change(before: float, after: float) -> str:
    """Two numbers in as few digits as tell them apart; counts in all of theirs."""
    few = f"{before:.6g}", f"{after:.6g}"
    whole = float(before).is_integer() and float(after).is_integer()
    return f"{before:.15g} to {after:.15g}" if whole or few[0] == few[1] else " to ".join(few)


def _told(point: PointDifference, *, pace: bool = True) -> list[str]:
    """What is different about a point; nothing where it is the same."""
    told = []
    if pace and point.pace in ("slower", "faster"):
        told.append(
            f"{point.pace}, {point.before:.3g} s to {point.after:.3g} s, {point.ratio.median:.3g} times "
            f"[{point.ratio.low:.3g}, {point.ratio.high:.3g}]{'' if point.ratio.coverage else ' (range)'}"
        )
    told += [f"{name} {_change(before, after)}" for name, (before, after) in point.counters.items()]
    if point.statuses is not None:
        told.append(f"{point.statuses[0]} before, {point.statuses[1]} now")
    return told


def _document(found: Difference) -> dict[str, Any]:
    return {
        "before": {"sweep": found.before.id, "started": found.before.started, "commit": found.before.commit},
        "after": {"sweep": found.after.id, "started": found.after.started, "commit": found.after.commit},
        "floor": found.floor,
        "drift": found.drift,
        "counts": {**found.counts, "untouched": found.untouched, "verdicts": len(found.verdicts)},
        "points": [
            {
                "experiment": point.experiment,
                "parameters": point.parameters,
                "pace": point.pace,
                "changed": point.changed,
                "run_seconds": [point.before, point.after],
                "ratio": {
                    "median": point.ratio.median,
                    "low": point.ratio.low,
                    "high": point.ratio.high,
                    "coverage": point.ratio.coverage,
                    "pairs": point.ratio.n,
                },
                "counters": {name: list(values) for name, values in point.counters.items()},
                "statuses": point.statuses,
            }
            for point in found.points
        ],
        "verdicts": [
            {"experiment": row.experiment, "before": row.before, "after": row.after, "statement": row.statement}
            for row in found.verdicts
        ],
    }
