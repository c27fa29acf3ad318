"""Where one method overtakes another, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

from markupsafe import Markup

from harness.measure.crossover import Crossover, Leader, crossover
from harness.measure.resolution import Resolution
from harness.report.point import MeasuredPoint
from harness.report.quantity import number
from harness.report.ranking import tell_apart
from harness.report.series import Arrangement, Series
from harness.report.words import is_noisy, metric_title, more_is_better

_MOST = 12


def crossing_sentences(arrangement: Arrangement) -> list[Markup]:
    """A sentence for each pair of series of a panel, on the first clock; nothing where x is no number.

    Nothing either of two that cannot be told apart at the largest x.
    """
    found = [_sentence(str(arrangement.x), metric, a, b, crossing) for metric, a, b, crossing in crossings(arrangement)]
    return found if len(found) <= _MOST else []


def crossings(arrangement: Arrangement) -> Iterator[tuple[str, Series, Series, Crossover]]:
    """The crossovers themselves: the clock, the two series, and where they cross."""
    clocks = [metric for metric in arrangement.metrics if is_noisy(metric) and not more_is_better(metric)]
    if not arrangement.numeric or arrangement.x is None or not clocks:
        return
    resolution = arrangement.resolution(clocks[0])
    for panel in arrangement.panels:
        lines = [series for series in arrangement.series if series.panel == panel]
        for a, b in combinations(lines, 2):
            if a.shares_scenes_with(b):
                crossing = crossover(_leaders(a, b, clocks[0], resolution))
                if crossing is not None:
                    yield clocks[0], a, b, crossing


def _sentence(x: str, metric: str, a: Series, b: Series, crossing: Crossover) -> Markup:
    winner, loser = (a, b) if crossing.ahead == "a" else (b, a)
    outcome = Markup("{} has a lower {} than {}").format(winner.label, metric_title(metric), loser.label)
    where = f", {a.panel}" if a.panel else ""
    if crossing.everywhere:
        return Markup("At every {} measured{}, {}: they do not cross there.").format(x, where, outcome)
    text = Markup("From {} <strong>{}</strong>{} on, {}").format(x, number(crossing.by), where, outcome)
    if crossing.after is None:
        return text + Markup("; at smaller ones they cannot always be told apart.")
    return text + Markup("; at {} it is the other way round: they cross between <strong>{}</strong> and {}.").format(
        number(crossing.after), number(crossing.after), number(crossing.by)
    )


def _leaders(a: Series, b: Series, metric: str, resolution: Resolution) -> dict[float, Leader]:
    """Who is ahead at each x that both have a cost at."""
    found: dict[float, Leader] = {}
    for point, x in zip(a.points, a.x, strict=True):
        other = b.at(x)
        if other is not None and math.isfinite(x) and _has_cost(point, metric) and _has_cost(other, metric):
            apart = tell_apart(point, other, metric, resolution) == "apart"
            found[float(x)] = ("a" if point.median(metric) < other.median(metric) else "b") if apart else ""
    return found


def _has_cost(point: MeasuredPoint, metric: str) -> bool:
    return point.can_be_ranked and not point.replaces_shape and point.median(metric) > 0
