"""What the process of a run is given, a task, and what it sends back, a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from harness.experiment.experiment import Point
from harness.methods.stages import Plan
from harness.motion.hits import Trace
from harness.store.recording import Recording
from harness.vocabulary import Status


@dataclass(frozen=True)
class Task:
    """One run to do.

    Parameters
    ----------
    point : Point
    files : identities of the files that its scene names, in the order of `SceneFiles.parts`
    timeout : s of elapsed time
    memory : B that it may use
    traced : keep every hit
    pinned : keep it on one core, where the system allows
    recorded : keep what a replay shows; its clocks are not to be used
    on_demand : metrics to measure that are measured on demand alone
    """

    point: Point
    files: tuple[str, ...]
    timeout: float
    memory: int
    traced: bool = False
    pinned: bool = False
    recorded: bool = False
    on_demand: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Report:
    """How a run ended; metrics, plan and trace only if it was ok.

    Parameters
    ----------
    status, reason : how it ended, and why, in a sentence, if not well
    conditions : of the machine meanwhile (`harness.measure.conditions`), and `flights`, how often the scene was flown
    stderr : the tail of what it printed
    recording : what a replay shows, if the task asks for it
    """

    status: Status
    reason: str | None
    metrics: dict[str, float] = field(default_factory=dict)
    plan: Plan | None = None
    trace: Trace | None = None
    conditions: Mapping[str, float] = field(default_factory=dict)
    stderr: str = ""
    recording: Recording | None = None

    def with_circumstances(self, stderr: str, conditions: Mapping[str, float]) -> Report:
        """The same report, with what the run printed and the conditions of the machine."""
        return replace(self, stderr=stderr, conditions={**self.conditions, **conditions})
