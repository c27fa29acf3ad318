"""Sums that keep their digits over 10^8 events, and absolute time."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.state import EPOCH, EPOCH_REST, SUMS, Floats, Tally


@step
def add(tally: Tally, entry: int, value: float) -> None:
    """Kahan's compensated addition."""
    sums = tally.sums
    corrected = value - sums[SUMS + entry]
    total = sums[entry] + corrected
    sums[SUMS + entry] = (total - sums[entry]) - corrected
    sums[entry] = total


@step
def absolute(clock: Floats, now: float) -> float:
    """Seconds since the start."""
    return float(clock[EPOCH] + (clock[EPOCH_REST] + now))
