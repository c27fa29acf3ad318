"""How much the finding of an experiment weighs: which of many the overview shows."""

from __future__ import annotations

import math

from harness.report.experiment import ExperimentPage
from harness.report.missing import is_judged
from harness.report.ranking import rank
from harness.report.words import is_noisy


def weight(page: ExperimentPage) -> tuple[int, float]:
    """The kind of what was found, and within a kind its size; the larger weighs more.

    A method that is told to be ahead weighs most, by the logarithm of the ratio to the last of those that it is ahead
    of; then what claims came to, by how many were decided; then the plain numbers.
    """
    if not page.findings.sentences:
        return 0, 0.0
    ahead = _ahead(page)
    if ahead > 0.0:
        return 3, ahead
    decided = sum(row.verdict != "undecided" for row in page.record.claims if is_judged(row))
    return (2, float(decided)) if decided else (1, 0.0)


def _ahead(page: ExperimentPage) -> float:
    """The logarithm of the largest ratio that the leader of the first clock is told to be ahead by, at the last x."""
    arrangement = page.arrangement
    metric = next((name for name in arrangement.metrics if is_noisy(name)), None)
    if metric is None:
        return 0.0
    methods = arrangement.methods
    x = arrangement.x_values[-1] if methods is arrangement.series and arrangement.x_values else None
    found = 0.0
    for panel in arrangement.panels:
        lines = [series for series in methods if series.panel == panel]
        for entry in rank(lines, x, metric, arrangement.resolution(metric)):
            if not entry.tied and entry.ratio is not None and 1.0 < entry.ratio.median < math.inf:
                found = max(found, math.log(entry.ratio.median))
    return found
