"""A sweep: every run that its experiments lack, one at a time, each kept as soon as it ends; then the verdicts."""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from harness.backends.registry import packages
from harness.backends.statement import missing
from harness.errors import InputError
from harness.experiment.criterion import Criterion
from harness.experiment.experiment import Experiment, Point
from harness.measure.machine import fingerprint, machine_facts, package_versions, source_commit
from harness.measure.metrics import METRICS
from harness.measure.noise import Control, controls_of
from harness.measure.verdicts import expected_refusals, verdict_on
from harness.motion.hits import Trace
from harness.runner.compilation import compile_ahead
from harness.runner.estimate import Estimate
from harness.runner.executor import Executor, FinishedJob, LocalExecutor
from harness.runner.key import point_key
from harness.runner.recording import worth_recording
from harness.runner.scene_of_point import body_count, derived_parameters
from harness.runner.schedule import Job, RunSelection, Schedule, schedule
from harness.runner.servers import Servers, files_of, on_demand_of, task_of
from harness.runner.task import Report
from harness.scene.scene_files import Opened, SceneFiles
from harness.store.database import Database
from harness.store.history import History
from harness.store.records import PointRow, RunRecord, VerdictKind, VerdictRow
from harness.store.tables import controls, run_records, run_table, runs

if TYPE_CHECKING:
    import pandas as pd


@dataclass
class SweepSummary:
    """What a sweep has done.

    Parameters
    ----------
    kept : runs that earlier sweeps had done already, by status
    done : runs done now, by status
    controls : control runs done now
    experiments : by the name of each experiment, the statuses of its runs of this sweep; a shared run counts for the
        first
    seconds : by the same names, the elapsed time of these runs
    broken : experiment and statement of every expectation that fails
    refused : runs that were rejected, as their experiment expects
    lacking : for every backend that is not installed, so that its points were left out, the reason
    """

    kept: Counter[str] = field(default_factory=Counter)
    done: Counter[str] = field(default_factory=Counter)
    controls: int = 0
    experiments: dict[str, Counter[str]] = field(default_factory=dict)
    seconds: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    broken: list[tuple[str, str]] = field(default_factory=list)
    refused: int = 0
    lacking: list[str] = field(default_factory=list)

    @property
    def failed(self) -> bool:
        """Whether a run, now or earlier, or an expectation failed."""
        statuses = self.kept + self.done
        return statuses.total() > statuses["ok"] + self.refused or bool(self.broken)


class ProgressListener(Protocol):
    """Is called as a sweep makes progress, between runs: only on a cluster may another run be timed meanwhile."""

    def begin(self, jobs: Sequence[Job], estimate: Estimate) -> None:
        """The sweep begins, with these runs to do."""

    def before(self, job: Job) -> None:
        """A run is about to begin."""

    def after(self, job: Job, report: Report) -> None:
        """A run has ended and is kept."""


class Work(NamedTuple):
    """What a sweep has to do: the key of each point by its id, those wanted, the runs, how long they may take.

    Points whose backend is an extra that is not installed are left out, with the reason in `lacking`: the other
    backends can be measured, and the next sweep after the installation does the rest.
    """

    keys: dict[int, str]
    wanted: set[str]
    schedule: Schedule
    estimate: Estimate
    lacking: dict[str, str]


def work_of(
    experiments: Sequence[Experiment],
    meshes: Opened,
    history: History | None,
    *,
    command: str,
    selection: RunSelection,
) -> Work:
    """The runs that a sweep has to do. Nothing is written.

    Parameters
    ----------
    experiments, meshes : loaded and opened
    history : what is measured already; None for nothing
    command : the command line that repeats the sweep: where it asks for fresh runs and was broken off, it goes on
    selection : which runs are wanted

    Raises
    ------
    InputError
        If no point matches `selection`.
    """
    keys: dict[int, str] = {}
    parameters: dict[str, dict[str, Any]] = {}
    on_demand: defaultdict[str, frozenset[str]] = defaultdict(frozenset)
    backends = sorted({point.engine.backend for experiment in experiments for point in experiment.points})
    lacking = {name: why for name in backends if (why := missing(name)) is not None}
    for experiment in experiments:
        for point in experiment.points:
            files = files_of(experiment, point, meshes)
            key = keys[id(point)] = point_key(point, files)
            parameters[key] = _parameters(point, files)
            on_demand[key] |= on_demand_of(experiment)
    wanted = {key for key, found in parameters.items() if selection.wants(found)}
    if selection.only and parameters and not wanted:
        raise InputError("--only: no point of these experiments has these values")
    wanted = {key for key in wanted if parameters[key]["backend"] not in lacking}
    if history is None:
        status: dict[str, dict[int, str]] = {key: {} for key in parameters}
        controlled: set[tuple[str, int]] = set()
    else:
        sweeps = history.unfinished_sweeps(command) if selection.fresh else None
        status, controlled = history.done(parameters, sweeps), history.controlled(parameters, sweeps)
        for key, repeat in history.lacking_metrics(on_demand):
            status[key].pop(repeat, None)
    found = schedule(experiments, keys, wanted, status, controlled, random.Random(), retry=selection.retry)
    jobs = [job if job.control else replace(job, on_demand=on_demand[job.key]) for job in found.jobs]
    found = found._replace(jobs=jobs)
    estimate = Estimate(history.durations() if history else {}, parameters)
    return Work(keys, wanted, found, estimate, lacking)


def sweep(
    experiments: Sequence[Experiment],
    meshes: Opened,
    database: Database,
    *,
    command: str,
    progress: ProgressListener,
    executor: Executor | None = None,
    selection: RunSelection | None = None,
) -> SweepSummary:
    """Do what is missing of these experiments and keep it.

    Parameters
    ----------
    experiments : loaded
    meshes : every mesh that they name, and recorded poses, opened
    database : open for writing
    command : the command line that repeats the sweep
    progress : is called before and after each run
    executor : where the runs are done; without, on this machine, one at a time
    selection : which of the runs to do; without, those that are missing

    Raises
    ------
    InputError
        If the database cannot be written to, or no point matches `selection`.
    """
    selection = selection or RunSelection()
    work = work_of(experiments, meshes, database.history, command=command, selection=selection)
    machine = machine_facts()
    machine["fingerprint"] = fingerprint(machine)
    number = database.begin_sweep(command, source_commit(), version("harness"), machine, package_versions(packages()))
    listed = {e.name: database.list_experiment(number, **_listing(e, work, meshes)) for e in experiments}
    summary = SweepSummary(work.schedule.kept, lacking=list(work.lacking.values()))
    progress.begin(work.schedule.jobs, work.estimate)
    if executor is None:
        compile_ahead([job.point for job in work.schedule.jobs])
    with executor or LocalExecutor() as opened:

        def do(jobs: Iterable[Job]) -> None:
            for finished in opened.run(jobs, meshes, progress.before):
                _keep(database, number, finished)
                _count(summary, finished)
                work.estimate.learn(finished.job, finished.report.conditions.get("seconds", 0.0))
                progress.after(finished.job, finished.report)

        do(work.schedule.jobs)
        if any(status != "ok" for status in summary.done):
            # now it is known which points fail, and can be no control: the others of their experiments stand in
            found = work_of(experiments, meshes, database.history, command=command, selection=selection)
            do([job for job in found.schedule.jobs if job.control])
        for finished in opened.run(_recordings(experiments, work.keys, database), meshes, lambda _: None):
            if finished.report.recording is not None:
                database.add_recording(finished.job.key, finished.report.recording)
    refused: set[tuple[str, int]] = set()
    for experiment in experiments:
        if not (experiment.expect or experiment.claims):  # a table takes half a second of imports
            continue
        table = runs(database.path, [experiment.name])
        known = _controls(database.path, experiment.name)
        expectations = [_verdict(row, table, experiment, "expectation", known) for row in experiment.expect]
        claims = [_verdict(row, table, experiment, "claim", known) for row in experiment.claims]
        database.add_verdicts(number, listed[experiment.name], "expectation", expectations)
        database.add_verdicts(number, listed[experiment.name], "claim", claims)
        summary.broken += [(experiment.name, row.statement) for row in expectations if row.verdict == "fails"]
        refused |= expected_refusals(experiment.expect, table[table["point"].isin(work.wanted)])
    summary.refused = len(refused)
    database.finish_sweep(number)
    return summary


def _keep(database: Database, sweep: int, finished: FinishedJob) -> None:
    """Put a run, or a control, into the database."""
    job, report = finished.job, finished.report
    if job.control:
        clocks = {name: value for name, value in report.metrics.items() if METRICS[name].clock}
        database.add_control(sweep, job.key, job.repeat, report.status, clocks, finished.machine)
        return
    database.add_run(
        sweep,
        job.key,
        job.repeat,
        report.status,
        report.reason,
        report.stderr,
        {name: (value, METRICS[name].unit) for name, value in report.metrics.items()},
        timing_grade=finished.timing_grade,
        started=finished.started,
        plan=asdict(report.plan) if report.plan else None,
        machine=finished.machine,
        conditions=report.conditions,
    )


def _recordings(experiments: Sequence[Experiment], keys: Mapping[int, str], database: Database) -> list[Job]:
    """For each experiment, the scene that its page should replay, unless it is recorded already."""
    jobs: dict[str, Job] = {}
    for experiment in experiments:
        points = {keys[id(point)]: point for point in experiment.points}
        if experiment.measure.tier == "long" or database.recorded(points):
            continue
        bodies = {key: body_count(point) for key, point in points.items()}
        key = worth_recording(bodies, run_records(database.path, [experiment.name]))
        if key is not None:
            jobs.setdefault(key, Job(experiment, points[key], key, 0, recorded=True))
    return list(jobs.values())


def _count(summary: SweepSummary, finished: FinishedJob) -> None:
    if finished.job.control:
        summary.controls += 1
        return
    name, status = finished.job.experiment.name, finished.report.status
    summary.done[status] += 1
    summary.experiments.setdefault(name, Counter())[status] += 1
    summary.seconds[name] += finished.report.conditions.get("seconds", 0.0)


def run(experiment: Experiment, meshes: Opened) -> pd.DataFrame:
    """Run every point of an experiment as often as it says, without a database.

    Returns
    -------
    DataFrame
        A row a run, in the columns of `harness.results`.
    """
    records = []
    with Servers() as servers:
        for repeat in range(experiment.measure.repeats):
            for point in experiment.points:
                task, files = task_of(experiment, point, meshes, pinned=True)
                report = servers.run(task, files)
                records.append(
                    RunRecord(
                        experiment=experiment.name,
                        point=point_key(point, files),
                        repeat=repeat,
                        status=report.status,
                        reason=report.reason,
                        sweep=0,
                        timing_grade=True,
                        parameters=_parameters(point, files),
                        metrics=report.metrics,
                    )
                )
    return run_table(records)


class RunError(Exception):
    """A single run failed; `report` says how it ended."""

    def __init__(self, report: Report) -> None:
        super().__init__(f"{report.status}: {report.reason}")
        self.report = report


def trace(experiment: Experiment, meshes: Opened) -> Trace:
    """The hits and the final state of the first point of an experiment.

    Raises
    ------
    RunError
    """
    with Servers() as servers:
        report = servers.run(*task_of(experiment, experiment.points[0], meshes, traced=True))
    if report.trace is None:
        raise RunError(report)
    return report.trace


def _parameters(point: Point, files: SceneFiles) -> dict[str, Any]:
    return {**point.parameters, **derived_parameters(point, files)}


def _listing(experiment: Experiment, work: Work, meshes: Opened) -> dict[str, Any]:
    """What the database keeps of an experiment, as arguments of `Database.list_experiment`."""
    named = {point.engine.backend for point in experiment.points}
    return {
        "name": experiment.name,
        "title": experiment.title,
        "question": experiment.question,
        "source": experiment.source,
        "specification": {
            "expect": [row.model_dump(mode="json", exclude_none=True) for row in experiment.expect],
            "claims": [row.model_dump(mode="json", exclude_none=True) for row in experiment.claims],
            "published": experiment.published.model_dump(mode="json") if experiment.published else None,
            "report": experiment.report.model_dump(mode="json") if experiment.report else None,
            "swept": list(experiment.swept),
            "measure": experiment.measure.model_dump(mode="json"),
            "path": str(experiment.path),
            "lacking": {name: why for name, why in work.lacking.items() if name in named},
        },
        "points": [
            PointRow(work.keys[id(point)], _parameters(point, files_of(experiment, point, meshes)))
            for point in experiment.points
        ],
    }


def _controls(path: str | Path, experiment: str) -> dict[str, Control]:
    """What the controls of an experiment tell of each clock."""
    first = {(run.point, run.repeat, run.machine): run.metrics for run in run_records(path, [experiment])}
    again = [((found.point, found.repeat, found.machine), found.metrics) for found in controls(path, [experiment])]
    return controls_of(first, again)


def _verdict(
    criterion: Criterion,
    table: pd.DataFrame,
    experiment: Experiment,
    kind: VerdictKind,
    known: Mapping[str, Control],
) -> VerdictRow:
    verdict = verdict_on(criterion, table, experiment.swept, kind, known)
    row = criterion.model_dump(mode="json", exclude_none=True)
    return VerdictRow(row, verdict.verdict, verdict.statement, verdict.detail)
