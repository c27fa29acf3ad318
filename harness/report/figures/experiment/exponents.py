"""The growth exponents of what is compared, with their intervals."""

from __future__ import annotations

from harness.report.drawing.exponents import Slope, draw_exponents
from harness.report.experiment import ExperimentPage
from harness.report.figure import Figure, FigureSource
from harness.report.words import metric_title

_MOST_SLOPES = 24


def _figures(page: ExperimentPage) -> list[Figure]:
    """None where there is too little range for any, or there are too many to read."""
    arrangement = page.arrangement
    several = len(arrangement.series) > 1
    slopes = [
        Slope(
            ", ".join(filter(None, (entry.series.label, entry.series.panel))) if several else entry.metric,
            entry.series.style if several else place,
            entry.exponent.value,
            entry.exponent.low,
            entry.exponent.high,
        )
        for place, entry in enumerate(page.growths)
        if entry.exponent.enough and page.compares(entry)
    ]
    leaf = arrangement.x
    if not slopes or len(slopes) > _MOST_SLOPES or leaf is None:
        return []
    of = f" of {metric_title(arrangement.metrics[0])}" if several else ""
    said = "; ".join(f"{slope.label} {slope.value:.2f}, {slope.low:.2f} to {slope.high:.2f}" for slope in slopes)
    figure = Figure(
        "exponents",
        f"Growth exponents{of} over {leaf}",
        f"Exponents with their intervals: {said}.",
        f"Exponents{of}: slopes on logarithmic axes, with their intervals. Dotted: the whole numbers.",
        lambda form, name: draw_exponents(slopes, leaf, form, name),
    )
    return [figure]


SOURCE = FigureSource(_figures, section="exponents")
