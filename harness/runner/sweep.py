"""A sweep: every run that its experiments lack, one at a time, each kept as soon as it ends; then the verdicts."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

from harness.experiment.criterion import Criterion
from harness.experiment.experiment import Experiment, Point
from harness.measure.machine import fingerprint, machine_facts, package_versions, source_commit
from harness.measure.metrics import METRICS
from harness.measure.verdicts import judge
from harness.motion.hits import Trace
from harness.runner.key import point_key
from harness.runner.servers import Servers, mesh_of
from harness.runner.setting import derived_parameters
from harness.runner.task import Report
from harness.scene.mesh import Mesh
from harness.store.database import Database
from harness.store.records import PointRow, RunRecord, VerdictKind, VerdictRow
from harness.store.tables import run_table, runs

Meshes = Mapping[Path, Mesh]


@dataclass(frozen=True)
class Job:
    """One run to do: a repeat of a point, for the first experiment that lists it."""

    experiment: Experiment
    point: Point
    key: str
    repeat: int


@dataclass
class Summary:
    """What a sweep has done.

    Parameters
    ----------
    kept : runs that earlier sweeps had done already, by status
    done : runs done now, by status
    failures : job and report of every run done now that is not ok
    broken : experiment and statement of every expectation that fails
    """

    kept: Counter[str] = field(default_factory=Counter)
    done: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[Job, Report]] = field(default_factory=list)
    broken: list[tuple[str, str]] = field(default_factory=list)

    @property
    def failed(self) -> bool:
        """Whether a run, now or earlier, or an expectation failed."""
        statuses = self.kept + self.done
        return statuses.total() > statuses["ok"] or bool(self.broken)


Watcher = Callable[[Job, Report], None]


def sweep(
    experiments: Sequence[Experiment],
    meshes: Meshes,
    database: Database,
    *,
    command: str,
    watch: Callable[[Sequence[Job]], Watcher],
) -> Summary:
    """Do what is missing of these experiments and keep it.

    Parameters
    ----------
    experiments : loaded
    meshes : every mesh that they name, opened
    database : open for writing
    command : the command line that repeats the sweep
    watch : called with all jobs before the first, returns what is called after each

    Raises
    ------
    InputError
        If the database cannot take what was measured.
    """
    machine = machine_facts()
    machine["fingerprint"] = fingerprint(machine)
    number = database.begin_sweep(command, source_commit(), version("harness"), machine, package_versions())
    keys = {id(point): point_key(point, mesh_of(e, point, meshes)) for e in experiments for point in e.points}
    listed = {e.name: database.list_experiment(number, **_listing(e, keys, meshes)) for e in experiments}
    jobs, kept = _missing(experiments, keys, database, random.Random(number))
    summary = Summary(kept)
    after_run = watch(jobs)
    with Servers() as servers:
        for job in jobs:
            started = datetime.now(timezone.utc)
            report = servers.run(job.experiment, job.point, meshes)
            database.add_run(
                number,
                job.key,
                job.repeat,
                report.status,
                report.reason,
                report.stderr,
                {name: (value, METRICS[name].unit) for name, value in report.metrics.items()},
                timing_grade=True,
                started=started,
                plan=asdict(report.plan) if report.plan else None,
            )
            summary.done[report.status] += 1
            if report.status != "ok":
                summary.failures.append((job, report))
            after_run(job, report)
    for experiment in experiments:
        table = runs(database.path, [experiment.name])
        expectations = [_verdict(criterion, table, experiment, "expectation") for criterion in experiment.expect]
        claims = [_verdict(criterion, table, experiment, "claim") for criterion in experiment.claims]
        database.add_verdicts(number, listed[experiment.name], "expectation", expectations)
        database.add_verdicts(number, listed[experiment.name], "claim", claims)
        summary.broken += [(experiment.name, row.statement) for row in expectations if row.verdict == "fails"]
    database.finish_sweep(number)
    return summary


def run(experiment: Experiment, meshes: Meshes) -> pd.DataFrame:
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
                report = servers.run(experiment, point, meshes)
                mesh = mesh_of(experiment, point, meshes)
                records.append(
                    RunRecord(
                        experiment=experiment.name,
                        point=point_key(point, mesh),
                        repeat=repeat,
                        status=report.status,
                        reason=report.reason,
                        sweep=0,
                        timing_grade=True,
                        parameters=_parameters(point, mesh),
                        metrics=report.metrics,
                    )
                )
    return run_table(records)


class RunError(Exception):
    """A single run that was asked for did not come to its end; `report` says how it ended."""

    def __init__(self, report: Report) -> None:
        super().__init__(f"{report.status}: {report.reason}")
        self.report = report


def trace(experiment: Experiment, meshes: Meshes) -> Trace:
    """The hits and the final state of the first point of an experiment.

    Raises
    ------
    RunError
    """
    with Servers() as servers:
        report = servers.run(experiment, experiment.points[0], meshes, traced=True)
    if report.trace is None:
        raise RunError(report)
    return report.trace


def _parameters(point: Point, mesh: Mesh | None) -> dict[str, Any]:
    return {**point.parameters, **derived_parameters(point, mesh)}


def _listing(experiment: Experiment, keys: Mapping[int, str], meshes: Meshes) -> dict[str, Any]:
    """What the database keeps of an experiment, as arguments of `Database.list_experiment`."""
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
        },
        "points": [
            PointRow(keys[id(point)], _parameters(point, mesh_of(experiment, point, meshes)))
            for point in experiment.points
        ],
    }


def _missing(
    experiments: Sequence[Experiment], keys: Mapping[int, str], database: Database, order: random.Random
) -> tuple[list[Job], Counter[str]]:
    """The runs still to do, and the statuses of those done.

    Blocks of one repeat of every point, each in random order: what drifts on the machine then meets all points alike.
    """
    status = database.done(keys.values())
    jobs: list[Job] = []
    kept: dict[tuple[str, int], str] = {}
    for repeat in range(max((experiment.measure.repeats for experiment in experiments), default=0)):
        block: dict[str, Job] = {}
        for experiment in experiments:
            for point in experiment.points if repeat < experiment.measure.repeats else ():
                key = keys[id(point)]
                if repeat in status[key]:
                    kept[key, repeat] = status[key][repeat]
                else:
                    block.setdefault(key, Job(experiment, point, key, repeat))
        jobs += order.sample(list(block.values()), len(block))
    return jobs, Counter(kept.values())


def _verdict(criterion: Criterion, table: pd.DataFrame, experiment: Experiment, kind: VerdictKind) -> VerdictRow:
    verdict = judge(criterion, table, experiment.swept, kind)
    row = criterion.model_dump(mode="json", exclude_none=True)
    return VerdictRow(row, verdict.verdict, verdict.statement, verdict.detail)
