"""What figures of lines share: when axes are logarithmic, what they are called, and a panel in words."""

from __future__ import annotations

from harness.measure.statistics import Summary
from harness.report.drawing.panels import Panel
from harness.report.quantity import Scale, number

# Below these ranges a logarithmic axis has no two round numbers on it.
_LOG_X, _LOG_Y = 4.0, 2.5
# Beyond this one most values of x stand at the left edge of an axis that is not.
_WIDE_X = 30.0


def spans_logarithms(panel: Panel) -> bool:
    """Whether both axes are positive and span enough for logarithms."""
    xs = [x for line in panel.lines for x in line.x]
    ys = [y for line in panel.lines for y in (*line.y, *line.low)]
    if not xs or min(xs) <= 0 or min(ys) <= 0:
        return False
    return max(xs) / min(xs) >= _LOG_X and max(ys) / min(ys) >= _LOG_Y


def spans_wide(panel: Panel) -> bool:
    """Whether x is positive and spans so much that its axis is logarithmic whatever y does."""
    xs = [x for line in panel.lines for x in line.x]
    return bool(xs) and min(xs) > 0 and max(xs) / min(xs) >= _WIDE_X


def axis_title(metric: str, unit: Scale) -> str:
    """A metric and the unit that its axis is in."""
    return f"{metric}, {unit.symbol}" if unit.symbol else metric


def median_text(found: Summary, unit: Scale) -> str:
    """A median with its interval, or its range, for one point.

    >>> median_text(Summary(2.0, 1.5, 3.0, 0.9375, 5), Scale(1.0, "s")).replace("\u00a0", " ")
    '2 s (interval 1.50 to 3 s)'
    """
    text = unit.with_unit(found.median)
    if found.n < 2 or found.low == found.high:
        return text
    kind = "range" if found.coverage is None else "interval"
    return f"{text} ({kind} {unit.text(found.low)} to {unit.with_unit(found.high)})"


def in_words(panel: Panel) -> str:
    """What the lines of a panel show, from end to end."""
    sentences = []
    for line in panel.lines:
        if line.y:
            ends = [
                (panel.categories[int(x)] if panel.categories else panel.x_text(x)) for x in (line.x[0], line.x[-1])
            ]
            unit = panel.y_label.rpartition(", ")[2] if ", " in panel.y_label else ""
            sentences.append(
                f"{line.label}: {number(line.y[0])} {unit} at {ends[0]}, {number(line.y[-1])} {unit} at {ends[1]}."
            )
    return (
        " ".join([f"{panel.title}:" if panel.title else "", *sentences]).replace("  ", " ").replace(" .", ".").strip()
    )
