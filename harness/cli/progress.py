"""The progress of a sweep, on standard error: two lines that are redrawn on a terminal, plain lines elsewhere.

It is written between runs and never during one, and by no thread of its own: drawing would disturb what is timed.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import monotonic
from typing import TYPE_CHECKING, Literal

from harness.runner.estimate import duration_text

if TYPE_CHECKING:
    from harness.runner.estimate import Estimate
    from harness.runner.schedule import Job
    from harness.runner.task import Report

Detail = Literal["quiet", "normal", "verbose"]

_LINE_EVERY = 30.0  # s between plain lines, at least
_DRAW_EVERY = 0.2  # s


class Progress:
    """Prints the progress of a sweep (see `harness.runner.sweep.ProgressListener`). A context.

    Parameters
    ----------
    detail : quiet prints only failures, verbose a line a run
    """

    def __init__(self, detail: Detail = "normal") -> None:
        from rich import progress
        from rich.console import Console

        self._detail = detail
        self._console = Console(stderr=True)
        self._drawn = self._console.is_terminal and detail != "quiet"
        self._bars = progress.Progress(
            progress.TextColumn("{task.description}", markup=False),
            progress.BarColumn(),
            progress.TextColumn("{task.fields[said]}", markup=False),
            console=self._console,
            transient=True,
            auto_refresh=False,
            disable=not self._drawn,
        )
        self._left: dict[Job, None] = {}
        self._next = 0.0

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self._bars.stop()

    def begin(self, jobs: Sequence[Job], estimate: Estimate) -> None:
        """Print how many runs there are to do and how long they may take."""
        self._estimate, self._total = estimate, len(jobs)
        self._left = dict.fromkeys(jobs)
        self._sweep = self._bars.add_task("sweep", total=len(jobs), said="")
        self._run = self._bars.add_task("", total=None, said="")
        if self._detail != "quiet":
            self._line(f"{len(jobs)} runs to do{self._time_left(', about {}')}")
        self._next = monotonic() + _LINE_EVERY
        self._bars.start()

    def before(self, job: Job) -> None:
        """Show the run that begins."""
        if self._drawn and monotonic() >= self._next:
            expected = self._estimate.of(job)
            said = f"about {duration_text(expected)}" if expected is not None else ""
            self._bars.update(self._run, description=name_of(job), said=said)
            self._draw()

    def after(self, job: Job, report: Report) -> None:
        """Count a run that has ended, and print it if it did not end well."""
        self._left.pop(job, None)
        if report.status != "ok" and not job.control:
            self._line(f"{name_of(job)}: {report.status}: {report.reason}")
        elif self._detail == "verbose":
            seconds = report.conditions.get("seconds")
            self._line(f"{name_of(job)}: {report.status}{f', {duration_text(seconds)}' if seconds is not None else ''}")
        if monotonic() < self._next or self._detail == "quiet":
            return
        if self._drawn:
            self._draw()
        else:
            done = self._total - len(self._left)
            self._line(f"{done} of {self._total} runs{self._time_left(', about {} left')}")
            self._next = monotonic() + _LINE_EVERY

    def _draw(self) -> None:
        done = self._total - len(self._left)
        self._bars.update(self._sweep, completed=done, said=f"{done} of {self._total}{self._time_left(', {} left')}")
        self._bars.refresh()
        self._next = monotonic() + _DRAW_EVERY

    def _time_left(self, words: str) -> str:
        seconds = self._estimate.left(self._left)
        return words.format(duration_text(seconds)) if seconds is not None and self._left else ""

    def _line(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)


def name_of(job: Job) -> str:
    """A run by what distinguishes it from the others of its experiment: its swept leaves and its repeat."""
    varied = [f"{leaf} {job.point.parameters[leaf]}" for leaf in job.experiment.swept]
    repeat = f"repeat {job.repeat}{', control' if job.control else ''}"
    return f"{job.experiment.name} ({', '.join([*varied, repeat])})"
