"""How wrong the hits of a run without response are: missed, extra, and late, against the contacts of the reference."""

from __future__ import annotations

import math

import numpy as np

from harness.arrays import Floats
from harness.motion.hits import Trace
from harness.reference.contacts import Contacts
from harness.reference.matching import match


def hit_errors(contacts: Contacts, onset_error: float, reported: Trace, dt: float | None) -> dict[str, float]:
    """The metrics that a run's hits are judged by.

    Parameters
    ----------
    contacts : of the reference
    onset_error : s, by which these may be wrong
    reported : what the run reported
    dt : s from frame to frame, of a stepped run; None of an event-driven one

    Returns
    -------
    dict
        `reference_hits`, `reference_error` (s), `missed_hits` and `extra_hits`; with matched hits `time_error` and
        `time_error_95` (s); of a stepped run `missed_hits_expected` and `missed_hits_deviation`.
    """
    between_bodies = reported.walls < 0
    until = min(contacts.duration, reported.time)
    found = match(contacts, reported.times[between_bodies], reported.bodies[between_bodies], until)
    metrics = {
        "reference_hits": float(found.hits),
        "reference_error": onset_error,
        "missed_hits": found.missed_share,
        "extra_hits": found.extra_share,
    }
    if len(found.errors):
        sizes = np.abs(found.errors)
        metrics |= {"time_error": float(np.median(sizes)), "time_error_95": float(np.quantile(sizes, 0.95))}
    if dt is not None and found.hits:
        metrics |= _between_frames(contacts.lengths[contacts.begin_until(until)], dt, found.missed)
    return metrics


def _between_frames(lengths: Floats, dt: float, missed: int) -> dict[str, float]:
    """What is missed where frames come at random: a contact of length t with probability 1 - t/dt, independently."""
    chances = np.maximum(0.0, 1.0 - lengths / dt)
    excess, deviation = missed - chances.sum(), math.sqrt((chances * (1.0 - chances)).sum())
    metrics = {"missed_hits_expected": float(chances.mean())}
    if deviation > 0.0 or excess == 0.0:
        metrics["missed_hits_deviation"] = float(excess / deviation) if deviation > 0.0 else 0.0
    return metrics
