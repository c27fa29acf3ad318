"""What is still to be measured: of the runs that experiments list, those that no sweep has come to.

A sweep that was interrupted, or still goes on, has broken nothing: what it lacks is one sentence, and no failure.
"""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from markupsafe import Markup

from harness.store.records import ExperimentRecord, VerdictRow
from harness.store.tables import NOT_JUDGED


def missing_runs(records: Sequence[ExperimentRecord], runs: pd.DataFrame) -> Markup | None:
    """A sentence on the runs that are missing; None where there are none.

    Parameters
    ----------
    records : of experiments; a run that several of them share counts once
    runs : the run table, which may hold others, too
    """
    listed = {
        (point.key, repeat)
        for record in records
        for point in record.points
        for repeat in range((record.specification.get("measure") or {}).get("repeats", 0))
    }
    missing = listed.difference(zip(runs["point"], runs["repeat"], strict=True))
    if missing:
        lack = f"{len(missing)} of {len(listed)} runs {'is' if len(missing) == 1 else 'are'} missing"
        return Markup("<strong>{}</strong>{}.").format(lack, _why(records, missing))
    if any(not is_judged(row) for record in records for row in (*record.expectations, *record.claims)):
        return Markup(
            "<strong>The sweep did not come to its end</strong>, and has judged nothing of what it measured; "
            "<code>harness sweep</code> does the rest."
        )
    return None


def _why(records: Sequence[ExperimentRecord], missing: set[tuple[str, int]]) -> Markup:
    """Of those whose backend the sweep did not find, what it said of that; of the others, what does them."""
    told = _passed_over(records)
    passed = [key for key, _ in missing if key in told]
    rest = len(missing) - len(passed)
    does = Markup("; <code>harness sweep</code> does the rest")
    parts = Markup("")
    if passed:
        reasons = "; ".join(sorted({told[key] for key in passed}))
        parts = Markup(": {} passed over ({})").format(f"{len(passed)} {_were(len(passed))}", reasons)
    if not rest or _broken_off(records):
        return parts + (does if rest else "")
    if not passed and any("lacking" not in record.specification for record in records):  # of an earlier version
        return Markup(
            ": they were not asked for, or their backend is not installed; <code>harness sweep</code> does those that "
            "it can, and says what brings the backends of the others"
        )
    return Markup("{}{} {} not asked for{}").format(parts, "," if passed else ":", f"{rest} {_were(rest)}", does)


def _were(count: int) -> str:
    return "was" if count == 1 else "were"


def _passed_over(records: Sequence[ExperimentRecord]) -> dict[str, str]:
    """By point, why the sweep that listed it could not use its backend."""
    return {
        point.key: why
        for record in records
        for point in record.points
        if (why := (record.specification.get("lacking") or {}).get(point.parameters.get("backend"))) is not None
    }


def is_judged(row: VerdictRow) -> bool:
    """Whether a sweep came to judge this row of `expect` or `claims`."""
    return row.statement != NOT_JUDGED


def is_complete(record: ExperimentRecord) -> bool:
    """Whether all that an experiment expects and claims was judged, as a sweep does in the end."""
    return all(map(is_judged, (*record.expectations, *record.claims)))


def _broken_off(records: Sequence[ExperimentRecord]) -> bool:
    return any(record.sweep.finished is None for record in records)
