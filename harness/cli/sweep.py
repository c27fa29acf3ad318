"""Run experiments and keep every measurement. What an earlier sweep has done is not done again.

Exit code 1 if a run failed or an expectation does not hold, 2 if an experiment or the database is wrong.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.cli.overrides import add_override_argument, overrides_of

if TYPE_CHECKING:
    from harness.runner.sweep import Job, Summary, Watcher
    from harness.runner.task import Report

DATABASE = "results/results.db"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("paths", metavar="PATH", nargs="*", default=["experiments"], help="files or folders")
    parser.add_argument("--db", metavar="FILE", default=DATABASE, help="the database (default: %(default)s)")
    parser.add_argument("--long", action="store_true", help="also experiments of `tier: long`")
    add_override_argument(parser)


def run(arguments: argparse.Namespace) -> int:
    import shlex
    import sys

    from harness.runner.preparation import prepare
    from harness.runner.sweep import sweep
    from harness.store.database import Database

    experiments, meshes = prepare(arguments.paths, overrides_of(arguments))
    chosen = [experiment for experiment in experiments if arguments.long or experiment.measure.tier == "default"]
    for left in [experiment.name for experiment in experiments if experiment not in chosen]:
        print(f"{left}: left out, since it is `tier: long`; --long runs it", file=sys.stderr)
    command = shlex.join(["harness", *sys.argv[1:]])
    with Database.open(arguments.db) as database, _Progress() as progress:
        try:
            summary = sweep(chosen, meshes, database, command=command, watch=progress.watch)
        except KeyboardInterrupt:
            print(f"interrupted; every finished run is kept. To go on: {command}", file=sys.stderr)
            return 130
    _say(summary, arguments.db)
    return 1 if summary.failed else 0


class _Progress:
    """Progress of a sweep on standard error: a bar on a terminal, a line a failure elsewhere."""

    def __enter__(self) -> _Progress:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        self._console = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("runs"),
            TimeRemainingColumn(),
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def watch(self, jobs: Sequence[Job]) -> Watcher:
        """Show how many runs there are to do; returns what is told of each."""
        bar = self._progress.add_task("sweep", total=len(jobs))
        if not self._console.is_terminal:
            self._console.print(f"{len(jobs)} runs to do", highlight=False)

        def after_run(job: Job, report: Report) -> None:
            self._progress.update(bar, advance=1, description=job.experiment.name)
            if report.status != "ok":
                self._console.print(
                    f"{_name(job)}: {report.status}: {report.reason}", markup=False, highlight=False, soft_wrap=True
                )

        return after_run


def _name(job: Job) -> str:
    varied = [f"{leaf} {job.point.parameters[leaf]}" for leaf in job.experiment.swept]
    return f"{job.experiment.name} ({', '.join([*varied, f'repeat {job.repeat}'])})"


def _say(summary: Summary, database: str) -> None:
    """The outcome, on standard output."""
    counts = ", ".join(f"{number} {status}" for status, number in sorted(summary.done.items()))
    told = f" ({counts})" if counts else ""
    print(f"{summary.done.total()} runs done{told}, {summary.kept.total()} kept from before")
    failed_before = summary.kept.total() - summary.kept["ok"]
    if failed_before:
        print(f"{failed_before} of those kept had failed; the report says why")
    for experiment, statement in summary.broken:
        print(f"{experiment}: expectation fails: {statement}")
    option = "" if database == DATABASE else f" --db {database}"
    print(f"Now `harness report{option}` turns {database} into pages.")
