"""Which runs a sweep has to do, and in what order.

Blocks of one repeat of every point, each in random order, so that a drift of the machine affects all points alike.
Where methods are compared, or a ratio of two points is claimed, each block holds a control as well: one of its runs
once more. How far two equal runs differ is the noise of the machine, and no smaller difference is reported.
"""

from __future__ import annotations

import json
import math
import random
from collections import Counter
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from harness.experiment.experiment import Experiment, Point
from harness.measure.statistics import FEWEST_FOR_INTERVAL
from harness.vocabulary import METHOD_LEAVES


@dataclass(frozen=True, eq=False)
class Job:
    """One run to do: a repeat of a point, for the first experiment that lists it; or its control, or its recording.

    `on_demand` are the metrics measured on demand alone that one of the experiments that list the point names.
    """

    experiment: Experiment
    point: Point
    key: str
    repeat: int
    control: bool = False
    on_demand: frozenset[str] = frozenset()
    recorded: bool = False


@dataclass(frozen=True)
class RunSelection:
    """Which runs a sweep is to do.

    Parameters
    ----------
    retry : do runs again that did not end well
    fresh : do all of them again
    only : leaf values, of which a point must have one for every leaf named here
    """

    retry: bool = False
    fresh: bool = False
    only: Mapping[str, Sequence[Any]] = field(default_factory=dict)

    def wants(self, parameters: Mapping[str, Any]) -> bool:
        """Whether a point with these leaves and derived parameters is to be run."""
        return all(any(_same(parameters.get(leaf), value) for value in values) for leaf, values in self.only.items())


class Schedule(NamedTuple):
    """Runs to do, in order, and the statuses of those that need not be done."""

    jobs: list[Job]
    kept: Counter[str]


def schedule(
    experiments: Sequence[Experiment],
    keys: Mapping[int, str],
    wanted: Set[str],
    status: Mapping[str, Mapping[int, str]],
    controlled: Set[tuple[str, int]],
    order: random.Random,
    *,
    retry: bool = False,
) -> Schedule:
    """The runs that are missing.

    Parameters
    ----------
    experiments : loaded
    keys : {id(point): key}
    wanted : keys of the points to run
    status : {key: {repeat: status}} of what is done
    controlled : keys and repeats that have their control
    order : the source of randomness
    retry : whether a run that did not end well counts as missing
    """
    failed = {key for key, ends in status.items() if any(ended != "ok" for ended in ends.values())}
    jobs: list[Job] = []
    kept: dict[tuple[str, int], str] = {}
    for repeat in range(max((experiment.measure.repeats for experiment in experiments), default=0)):
        block: dict[tuple[str, bool], Job] = {}
        for experiment in experiments:
            if repeat >= experiment.measure.repeats:
                continue
            points = [point for point in experiment.points if keys[id(point)] in wanted]
            for point in points:
                key = keys[id(point)]
                ended = status[key].get(repeat)
                if ended is None or (retry and ended != "ok"):
                    block.setdefault((key, False), Job(experiment, point, key, repeat))
                else:
                    kept[key, repeat] = ended
            chosen = _controlled_point(experiment, [p for p in points if keys[id(p)] not in failed], repeat)
            if chosen is not None and (keys[id(chosen)], repeat) not in controlled:
                key = keys[id(chosen)]
                block.setdefault((key, True), Job(experiment, chosen, key, repeat, control=True))
        jobs += order.sample(list(block.values()), len(block))
    return Schedule(jobs, Counter(kept.values()))


def _controlled_point(experiment: Experiment, points: Sequence[Point], repeat: int) -> Point | None:
    """Which of these points has its run of this repeat done twice: another for each, at equal steps over all.

    None where nothing is compared, or with too few repeats for an interval. A point that has failed is not among them,
    as nothing of a failed run can be compared.
    """
    repeats = experiment.measure.repeats
    compares = bool(set(experiment.swept).intersection(METHOD_LEAVES)) or any(
        criterion.ratio_to is not None for criterion in (*experiment.claims, *experiment.expect)
    )
    if not points or repeats < FEWEST_FOR_INTERVAL or not compares:
        return None
    return points[(2 * repeat + 1) * len(points) // (2 * repeats)]


def _same(value: Any, wanted: Any) -> bool:
    if _is_number(value) and _is_number(wanted):
        return math.isclose(value, wanted, rel_tol=1e-9)
    return bool(json.dumps(value, sort_keys=True) == json.dumps(wanted, sort_keys=True))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
