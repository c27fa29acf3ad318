"""A ratio in a sentence."""

from __future__ import annotations

from markupsafe import Markup

from harness.measure.statistics import Summary
from harness.report.quantity import number


def ratio_text(ratio: Summary) -> Markup:
    """A ratio with its interval in brackets; a range, where it is only that, says so, and one pair has neither."""
    text = Markup("<strong>{}×</strong>").format(number(ratio.median))
    if ratio.n < 2:
        return text
    kind = "" if ratio.coverage is not None else " (range)"
    return text + Markup(" [{}, {}]{}").format(number(ratio.low), number(ratio.high), kind)
