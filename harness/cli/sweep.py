"""Run experiments and keep every measurement. A run that an earlier sweep has done is not done again.

Exit code 1 if a run failed or an expectation does not hold, 2 if an experiment or the database is wrong.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from harness import DATABASE
from harness.cli.arguments import positive_count
from harness.cli.overrides import add_override_argument, overrides_of
from harness.cli.width import say
from harness.errors import InputError, Problem
from harness.experiment import FOLDER

if TYPE_CHECKING:
    from harness.experiment.experiment import Experiment
    from harness.runner.executor import Executor
    from harness.runner.schedule import RunSelection
    from harness.runner.sweep import SweepSummary
    from harness.scene.scene_files import Opened


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("paths", metavar="PATH", nargs="*", default=[FOLDER], help="files or folders")
    parser.add_argument("--db", metavar="FILE", default=DATABASE, help="the database (default: %(default)s)")
    parser.add_argument("--long", action="store_true", help="also experiments of `tier: long`")
    add_override_argument(parser)
    which = parser.add_argument_group("which runs")
    which.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="LEAF=VALUE",
        help="only points with this value of a leaf, such as backend=fcl; given again, another value of the same leaf "
        "adds points and another leaf takes some away",
    )
    again = which.add_mutually_exclusive_group()
    again.add_argument("--retry", choices=["failed"], help="do runs again that did not end well")
    again.add_argument(
        "--fresh", action="store_true", help="do every run again; the earlier ones are kept (`harness diff` compares)"
    )
    which.add_argument("--dry-run", action="store_true", help="say what would be done and how long it may take")
    where = parser.add_argument_group("where").add_mutually_exclusive_group()
    where.add_argument(
        "--jobs", type=positive_count, metavar="N", help="N runs at a time on this machine; their times do not count"
    )
    where.add_argument(
        "--cluster",
        type=_address,
        metavar="ADDRESS",
        help="on the workers of a Dask scheduler, tcp://HOST:PORT; or local:N, as --jobs",
    )
    saying = parser.add_mutually_exclusive_group()
    saying.add_argument("--quiet", action="store_true", help="say only what goes wrong, and the outcome")
    saying.add_argument("--verbose", action="store_true", help="a line a run")


def run(arguments: argparse.Namespace) -> int:
    import shlex
    import sys

    from harness.cli.interruption import exit_code
    from harness.cli.progress import Progress
    from harness.runner.preparation import prepare
    from harness.runner.sweep import sweep
    from harness.store.database import Database

    selection = _selection(arguments)
    experiments, meshes = prepare(arguments.paths, overrides_of(arguments), lambda line: print(line, file=sys.stderr))
    chosen = [experiment for experiment in experiments if arguments.long or experiment.measure.tier == "default"]
    for left in [experiment.name for experiment in experiments if experiment not in chosen]:
        print(f"{left}: left out, since it is `tier: long`; --long runs it", file=sys.stderr)
    command = shlex.join(["harness", *sys.argv[1:]])
    if arguments.dry_run:
        _print_what_would_be_done(chosen, meshes, arguments, command, selection)
        return 0
    progress = Progress("quiet" if arguments.quiet else "verbose" if arguments.verbose else "normal")
    with Database.open(arguments.db) as database, progress:
        try:
            summary = sweep(
                chosen,
                meshes,
                database,
                command=command,
                progress=progress,
                executor=_executor(arguments),
                selection=selection,
            )
            compared: list[str] = []
            if any(experiment.measure.families or experiment.measure.compare for experiment in chosen):
                from harness.cli.comparisons import compare_asked  # its imports take as long as a short sweep

                compared = compare_asked(
                    chosen, meshes, database, command=command, fresh=arguments.fresh, quiet=arguments.quiet
                )
        except KeyboardInterrupt as interruption:
            print(f"interrupted; every finished run is kept. To go on: {command}", file=sys.stderr)
            return exit_code(interruption)
    _print_outcome(summary, arguments)
    for line in compared:
        print(line)
    return 1 if summary.failed else 0


def _selection(arguments: argparse.Namespace) -> RunSelection:
    from harness.experiment.document import read_value
    from harness.experiment.leaves import DERIVED, LEAVES
    from harness.experiment.messages import near, shown
    from harness.runner.schedule import RunSelection

    only: dict[str, list[Any]] = {}
    problems = []
    for text in arguments.only:
        leaf, equals, value = (part.strip() for part in text.partition("="))
        if not (leaf and equals):
            problems.append(Problem(f"--only {text}: must be LEAF=VALUE, such as backend=fcl"))
        elif leaf not in (*LEAVES, *DERIVED):
            problems.append(Problem(f"--only {text}: unknown leaf {shown(leaf)}{near(leaf, (*LEAVES, *DERIVED))}"))
        else:
            try:
                only.setdefault(leaf, []).append(read_value(value))
            except InputError as error:
                problems += [Problem(f"--only {text}: {problem.message}") for problem in error.problems]
    if problems:
        raise InputError(problems)
    return RunSelection(retry=arguments.retry == "failed", fresh=arguments.fresh, only=only)


def _executor(arguments: argparse.Namespace) -> Executor | None:
    """None for this machine, one run at a time."""
    address = f"local:{arguments.jobs}" if arguments.jobs and arguments.jobs > 1 else arguments.cluster
    if address is None:
        return None
    from harness.runner.cluster import Cluster

    return Cluster(address)


def _address(text: str) -> str:
    kind, _, rest = text.partition(":")
    if kind == "local":
        if not (rest.isdecimal() and int(rest)):
            raise argparse.ArgumentTypeError(f"{text}: must be local:N, with a number N of 1 or more")
    elif "://" not in text:
        raise argparse.ArgumentTypeError(f"{text}: must be tcp://HOST:PORT or local:N")
    return text


def _print_what_would_be_done(
    experiments: Sequence[Experiment],
    meshes: Opened,
    arguments: argparse.Namespace,
    command: str,
    selection: RunSelection,
) -> None:
    """Print what a sweep would do. Nothing is written, and no database is made."""
    import os
    from contextlib import nullcontext

    from harness.runner.estimate import START_UP, duration_text
    from harness.runner.sweep import work_of
    from harness.store.history import history_of

    there = os.path.exists(arguments.db) and os.path.getsize(arguments.db) > 0
    with history_of(arguments.db) if there else nullcontext() as history:
        work = work_of(experiments, meshes, history, command=command.replace(" --dry-run", ""), selection=selection)
    jobs, kept = work.schedule
    rows = []
    for experiment in experiments:
        mine = [job for job in jobs if job.experiment is experiment]
        seconds = work.estimate.left(mine)
        rows.append([experiment.name, str(len(mine)), "unknown" if seconds is None else duration_text(seconds)])
    _print_table(["experiment", "runs to do", "time"], rows)
    backends = {job.point.engine.backend for job in jobs}
    total = work.estimate.left(jobs)
    known = sum(work.estimate.of(job) is not None for job in jobs)
    if not jobs:
        time = "nothing to do"
    elif total is None:
        time = "no such run was done before, so there is no estimate of time"
    else:
        time = f"about {duration_text(total + START_UP * len(backends))}, from earlier runs of {known} of them"
    for why in work.lacking.values():
        say(f"points passed over: {why}")
    say(f"{len(jobs)} runs to do, {kept.total()} kept from before: {time}")


def _print_outcome(summary: SweepSummary, arguments: argparse.Namespace) -> None:
    """The outcome, on standard output."""
    import shlex

    from harness.runner.estimate import duration_text

    if not arguments.quiet and summary.experiments:
        rows = []
        for name, statuses in summary.experiments.items():
            failed = ", ".join(f"{number} {status}" for status, number in sorted(statuses.items()) if status != "ok")
            rows.append([name, str(statuses.total()), failed or "none", duration_text(summary.seconds[name])])
        _print_table(["experiment", "runs", "failed", "time"], rows)
    listed = ", ".join(f"{number} {status}" for status, number in sorted(summary.done.items()))
    by_status = f" ({listed})" if listed else ""
    done = summary.done.total()
    say(f"{done} run{'' if done == 1 else 's'} done{by_status}, {summary.kept.total()} kept from before")
    if summary.controls:
        say(f"{summary.controls} of them done twice, as a control of the noise")
    failed_before = summary.kept.total() - summary.kept["ok"]
    if failed_before:
        say(f"{failed_before} of those kept had failed; the report says why, --retry failed does them again")
    for why in summary.lacking:
        say(f"points passed over: {why}")
    for experiment, statement in summary.broken:
        say(f"{experiment}: expectation fails: {statement}")
    option = "" if arguments.db == DATABASE else f" --db {shlex.quote(arguments.db)}"
    if arguments.db.startswith("-"):  # else it would be taken for an option
        option = option.replace("--db ", "--db=", 1)
    say(f"Now `harness report{option}` turns {arguments.db} into pages.")


def _print_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Columns, the first to the left and the others to the right."""
    widths = [max(map(len, column)) for column in zip(titles, *rows, strict=True)]
    for row in (titles, *rows):
        first, *others = (text.ljust(width) if not place else text.rjust(width)
                          for place, (text, width) in enumerate(zip(row, widths, strict=True)))  # fmt: skip
        print("  ".join([first, *others]).rstrip())
