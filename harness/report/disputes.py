"""Methods that saw different hits of the same motion, so that one of them at least is wrong.

Until it is known which, nobody of that scene is ranked. With response none the motion is the same for all: methods that
step through it in equal frames, and see the same shape, must answer the same hits. Where there is a reference, or where
a comparison has judged their verdicts at poses of the experiment, it is known who is right.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

from harness.report.backends.correctness import Correctness
from harness.report.point import MeasuredPoint
from harness.store.records import ExperimentRecord
from harness.vocabulary import MethodName

# What a run says of the hits that it saw.
_ANSWERS = ("event_digest", "pair_hits", "pair_contacts", "near_pairs")


def disputed(record: ExperimentRecord, points: Sequence[MeasuredPoint], known: Correctness) -> frozenset[str]:
    """The keys of all points of which it is not known whether their hits are right, while others saw different ones.

    Parameters
    ----------
    record : of the experiment
    points : all of its points
    known : what comparisons at poses of the experiment have found
    """
    if (record.specification.get("measure") or {}).get("reference"):
        return frozenset()
    groups: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        if point.parameters.get("response") == "none" and len(point.values("event_digest")):
            groups.setdefault(_motion(point), []).append(point)
    found: set[str] = set()
    for members in groups.values():
        if len({answer for point in members for answer in _answers(point)}) < 2:
            continue
        methods = {MethodName.of(point.parameters) for point in members}
        if not all(known.is_right(method) or known.is_wrong(method) for method in methods):
            found.update(point.row.key for point in members)
    return frozenset(found)


def _motion(point: MeasuredPoint) -> str:
    """What must be the same of two points for their hits to be: scene, frames, question, and what is seen of a body."""
    query = MethodName.of(point.parameters).query
    seen = [point.parameters.get("shape"), point.parameters.get("dt"), query, point.row.plan.get("warnings")]
    return json.dumps([point.scene, seen], sort_keys=True)


def _answers(point: MeasuredPoint) -> set[tuple[float, ...]]:
    """What its runs saw: one answer, unless the method gives another each time."""
    said = (point.values(name).tolist() for name in _ANSWERS)
    return set(zip(*(values for values in said if values), strict=False))
