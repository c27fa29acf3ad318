"""What the error of a method is, by what it was asked: that of the times of hits, or that of gaps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ErrorKind:
    """An error, and what makes a method wrong whatever its error is.

    Parameters
    ----------
    metric, tail, unit : the error of a run, a second figure of it, and their unit
    typical, tail_title : what the two are, such as "median" and "95th percentile"
    of : completes "the error of …"
    things : of what a method may miss some or report too many
    missed, extra : metrics of their shares
    known, reference : metrics: how many of them the reference has, and how wrong it may be
    targets : errors at which methods are compared
    preferred : at which of these a sentence says what to use, if anything reaches it
    """

    metric: str
    tail: str
    unit: str
    typical: str
    tail_title: str
    of: str
    things: str
    missed: str
    extra: str
    known: str
    reference: str
    targets: tuple[float, ...]
    preferred: float


TIMES = ErrorKind(
    metric="time_error",
    tail="time_error_95",
    unit="s",
    typical="median",
    tail_title="95th percentile",
    of="the times of hits",
    things="hits",
    missed="missed_hits",
    extra="extra_hits",
    known="reference_hits",
    reference="reference_error",
    targets=(1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
    preferred=1e-4,
)
# most gaps are exact or 0, so that a median says nothing
GAPS = ErrorKind(
    metric="gap_error_most",
    tail="witness_error",
    unit="m",
    typical="largest",
    tail_title="Nearest points",
    of="gaps",
    things="pairs",
    missed="missed_pairs",
    extra="extra_pairs",
    known="reference_pairs",
    reference="reference_gap_error",
    targets=(1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
    preferred=1e-6,
)


def error_kind(parameters: Mapping[str, Any]) -> ErrorKind:
    """The error of a run with these leaves."""
    return GAPS if parameters.get("query") == "distance" else TIMES
