"""Where one method overtakes another, in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from markupsafe import Markup

from harness.measure.crossover import Crossover, crossover
from harness.report.quantity import number
from harness.report.series import Arrangement, Series
from harness.report.words import is_noisy, metric_title, more_is_better

_MOST = 12


def crossing_sentences(arrangement: Arrangement) -> list[Markup]:
    """A sentence for each pair of series of a panel, on the first clock; nothing where x is no number."""
    clocks = [metric for metric in arrangement.metrics if is_noisy(metric) and not more_is_better(metric)]
    if not arrangement.numeric or arrangement.x is None or not clocks:
        return []
    found = []
    for panel in arrangement.panels:
        lines = [series for series in arrangement.series if series.panel == panel]
        for a, b in combinations(lines, 2):
            if not a.shares_scenes_with(b):
                continue
            crossing = crossover(_costs(a, clocks[0]), _costs(b, clocks[0]))
            if crossing is not None:
                found.append(_sentence(arrangement.x, clocks[0], a, b, crossing))
    return found if len(found) <= _MOST else []


def _sentence(x: str, metric: str, a: Series, b: Series, crossing: Crossover) -> Markup:
    winner, loser = (a, b) if crossing.ahead == "a" else (b, a)
    at = crossing.at
    outcome = Markup("{} has a lower {} than {}").format(winner.label, metric_title(metric), loser.label)
    where = f", {a.panel}" if a.panel else ""
    if at is None:
        return Markup("At every {} measured{}, {}: they do not cross.").format(x, where, outcome)
    interval = f" [{number(at.low)}, {number(at.high)}]" if at.n > 1 else ""
    return Markup("From {} <strong>{}</strong>{}{} on, {}.").format(x, number(at.median), interval, where, outcome)


def _costs(series: Series, metric: str) -> dict[float, dict[tuple[int, str], float]]:
    pairs: Sequence[tuple[float, dict[tuple[int, str], float]]] = [
        (float(x), {place: value for place, value in point.by_place(metric).items() if value > 0})
        for point, x in zip(series.points, series.x, strict=True)
        if not point.is_wrong
    ]
    return {x: costs for x, costs in pairs if costs and math.isfinite(x)}
