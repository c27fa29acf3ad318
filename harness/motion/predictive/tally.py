"""Sums that keep their digits over 10^8 events."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.state import Record


@step
def add(entry: Record, value: float) -> None:
    """Kahan's compensated addition, to a SUM."""
    corrected = value - entry.rest
    total = entry.total + corrected
    entry.rest = (total - entry.total) - corrected
    entry.total = total
