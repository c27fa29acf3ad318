"""What is asked of a run's process, and what comes back."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from harness.experiment.experiment import Point
from harness.motion.hits import Trace
from harness.motion.plan import Plan

Status = Literal["ok", "failed", "timeout", "memory", "crashed", "rejected"]


@dataclass(frozen=True)
class Task:
    """One run to do.

    Parameters
    ----------
    point : Point
    mesh : digest of its mesh, if it has one
    timeout : s of elapsed time
    memory : B that it may use
    traced : keep every hit
    """

    point: Point
    mesh: str | None
    timeout: float
    memory: int
    traced: bool = False


@dataclass(frozen=True)
class Report:
    """How a run ended; metrics, plan and trace only if it was ok. `stderr` is the tail of what it printed."""

    status: Status
    reason: str | None
    stderr: str = ""
    metrics: dict[str, float] = field(default_factory=dict)
    plan: Plan | None = None
    trace: Trace | None = None

    def with_stderr(self, stderr: str) -> Report:
        """The same report with what the run printed."""
        return replace(self, stderr=stderr)
