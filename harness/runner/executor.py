"""Where runs are done: on this machine one after another, or on workers of a cluster (`harness.runner.cluster`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timezone
from types import TracebackType
from typing import Any, Protocol

from harness.runner.schedule import Job
from harness.runner.servers import Servers, task_of
from harness.runner.task import Report
from harness.scene.scene_files import Opened


@dataclass(frozen=True)
class FinishedJob:
    """A job that has ended, and how.

    Parameters
    ----------
    timing_grade : whether no other run of the sweep was on its machine at the same time
    started : with its time zone
    machine : facts of where it ran; None for the machine of the sweep
    """

    job: Job
    report: Report
    timing_grade: bool
    started: datetime
    machine: Mapping[str, Any] | None = None


class Executor(Protocol):
    """A context that does jobs; leaving it ends every process that it started."""

    def __enter__(self) -> Executor: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def run(self, jobs: Iterable[Job], meshes: Opened, before: Callable[[Job], None]) -> Iterator[FinishedJob]:
        """Do the jobs, about in this order; each is yielded when it ends.

        Parameters
        ----------
        jobs, meshes : what to do, and every mesh that it needs
        before : called when a job is about to begin, before anything of it is timed
        """


class LocalExecutor:
    """One run at a time on this machine, each on a core of its own."""

    def __init__(self) -> None:
        self._servers = Servers()

    def __enter__(self) -> LocalExecutor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._servers.close()

    def run(self, jobs: Iterable[Job], meshes: Opened, before: Callable[[Job], None]) -> Iterator[FinishedJob]:
        """See `Executor`."""
        for job in jobs:
            before(job)
            task, files = task_of(
                job.experiment, job.point, meshes, pinned=True, recorded=job.recorded, on_demand=job.on_demand
            )
            started = datetime.now(timezone.utc)
            yield FinishedJob(job, self._servers.run(task, files), timing_grade=True, started=started)
