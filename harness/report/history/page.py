"""What the page of the history says: the sweeps of each machine, the steps, and every point over its sweeps."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from harness.measure.metrics import METRICS
from harness.report.history.history import FEWEST_SWEEPS, MachineHistory, package_changes
from harness.report.machine import machine_text
from harness.report.quantity import number, plural, scale
from harness.report.table import Column, Entry, Table, measured_summary, plain, words
from harness.report.words import metric_title

_MOST_ROWS = 300
_MOST_SWEEPS = 8


def sweeps_table(machine: MachineHistory) -> Table:
    """Commit, version and drift of every sweep."""
    rows, earlier = [], None
    for sweep in machine.sweeps:
        drift = machine.drifts.get(sweep.id)
        rows.append(
            (
                Entry(str(sweep.id), numeric=False, sort=plain(sweep.id)),
                words(sweep.started.replace("T", " ")[:19]),
                words((sweep.commit or "unknown")[:12]),
                words(", ".join([f"harness {sweep.version}", *package_changes(sweep, earlier)])),
                Entry("–" if drift is None else f"{number(drift)}×", sort=plain(drift)),
            )
        )
        earlier = sweep
    columns = (
        Column("Sweep", numeric=False), Column("started, UTC", numeric=False), Column("commit", numeric=False),
        Column("version, and packages that changed", numeric=False), Column("drift of the machine"),
    )  # fmt: skip
    note = (
        "Drift: what all points together took, as a multiple of the first sweep, up to a factor of two from one sweep "
        "to the next. It is taken out before steps are looked for. A sweep that shares too few points with those "
        "before it has none."
    )
    return Table("Sweeps", note, columns, tuple(rows))


def steps_table(machine: MachineHistory) -> Table | None:
    """Every step, the newest first."""
    if not machine.steps:
        return None
    rows = tuple(
        (
            words(point.experiment or "no longer listed"),
            Entry(point.label or "the only one", numeric=False, mark="long"),
            Entry(f"{number(step.ratio)}×", flag="slower" if step.ratio > 1.0 else "", sort=plain(step.ratio)),
            Entry(str(step.sweep.id), sort=plain(step.sweep.id)),
            words(f"{(step.before.commit or 'unknown')[:12]} → {(step.sweep.commit or 'unknown')[:12]}"),
        )
        for point, step in machine.steps
    )
    columns = (
        Column("Experiment", numeric=False), Column("Point", numeric=False), Column("new / old"),
        Column("from sweep"), Column("commits", numeric=False),
    )  # fmt: skip
    return Table("Steps", "Where a point changed for good, without the drift of the machine.", columns, rows)


def points_table(machine: MachineHistory, metric: str) -> Table | None:
    """Every point that two sweeps or more have measured, over the newest of them."""
    shown = machine.sweeps[-_MOST_SWEEPS:]
    points = [point for point in machine.points if len(point.values) > 1]
    if not points:
        return None
    unit = scale([found.median for point in points for found in point.values.values()], METRICS[metric].unit)
    rows = tuple(
        (
            words(point.experiment or "no longer listed"),
            Entry(point.label or "the only one", numeric=False, mark="long"),
            *(measured_summary(point.values.get(sweep.id), unit) for sweep in shown),
        )
        for point in points[:_MOST_ROWS]
    )
    note = f"{metric_title(metric).capitalize()}, CPU {unit.symbol}, medians with half their interval."
    if len(points) > _MOST_ROWS:
        note += f" The first {_MOST_ROWS} of {plural(len(points), 'point')}; all are in “harness history --all”."
    columns = (
        Column("Experiment", numeric=False), Column("Point", numeric=False),
        *(Column(f"sweep {sweep.id}") for sweep in shown),
    )  # fmt: skip
    return Table("Points", note, columns, rows)


def sentences(machines: Sequence[MachineHistory]) -> list[Markup]:
    """What changed for good, in sentences."""
    found = []
    for machine in machines:
        long = sum(len(point.values) >= FEWEST_SWEEPS for point in machine.points)
        text = Markup("{}: {} over {}, <strong>{}</strong>.").format(
            machine_text(machine.facts),
            plural(len(machine.points), "point"),
            plural(len(machine.sweeps), "sweep"),
            plural(len(machine.steps), "step") if long else "too few sweeps of any point to tell a step",
        )
        found.append(text)
    return found
