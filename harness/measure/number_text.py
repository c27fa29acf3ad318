"""Measured numbers and their intervals, as the statement of a verdict has them."""

from __future__ import annotations

import math

from harness.measure.statistics import Summary


def interval_text(found: Summary) -> str:
    """A median with its interval, or with the range of its repeats where these are too few for one.

    >>> interval_text(Summary(2.5, 2.0, 3.0, 0.9375, 5))
    '2.50 [2, 3]'
    >>> interval_text(Summary(2.5, 2.0, 3.0, None, 3))
    '2.50 (range of 3 repeats: [2, 3])'
    """
    if found.n == 0:
        return "unknown"
    if found.low == found.high:
        return number_text(found.median)
    span = f"[{number_text(found.low)}, {number_text(found.high)}]"
    if found.coverage is None:
        return f"{number_text(found.median)} (range of {found.n} repeats: {span})"
    return f"{number_text(found.median)} {span}"


def number_text(value: float) -> str:
    """Whole numbers in full, others to three significant digits.

    >>> number_text(12345.0), number_text(0.012345), number_text(1234.5)
    ('12345', '0.0123', '1234')
    """
    if math.isfinite(value) and abs(value) < 1e15 and (float(value).is_integer() or abs(value) >= 1000.0):
        return f"{value:.0f}"
    return f"{value:#.3g}".removesuffix(".")
