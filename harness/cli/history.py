"""Show a metric over all sweeps of each machine, and where a point got slower or faster for good.

A step needs two sweeps on either side and more than 10 %, beyond what all points have in common. Where nothing changed,
fewer than one history in twenty names any.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from harness import DATABASE
from harness.cli.json_document import json_text
from harness.cli.width import say

if TYPE_CHECKING:
    from harness.measure.statistics import Summary
    from harness.report.history.history import MachineHistory


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiments", metavar="EXPERIMENT", nargs="*", help="names of experiments (default: all)")
    parser.add_argument("--db", metavar="FILE", default=DATABASE, help="the database (default: %(default)s)")
    parser.add_argument("--metric", default="run_seconds", help="what to follow (default: %(default)s)")
    parser.add_argument("--all", action="store_true", help="print every point, not only those with a step")
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    from harness.report.history.history import history

    found = history(arguments.db, arguments.metric, arguments.experiments)
    if arguments.json:
        document = {"metric": arguments.metric, "machines": [_document(machine) for machine in found]}
        print(json_text(document))
        return 0
    for machine in found:
        _say(machine, arguments.metric, everything=arguments.all)
    if not found:
        say(f"no run reports {arguments.metric}")
    return 0


def _say(machine: MachineHistory, metric: str, *, everything: bool) -> None:
    from harness.measure.metrics import METRICS
    from harness.report.history.history import FEWEST_SWEEPS, package_changes
    from harness.report.machine import machine_text
    from harness.report.quantity import plural, quantity

    say(f"machine {machine.fingerprint}: {machine_text(machine.facts)}")
    earlier = None
    for sweep in machine.sweeps:
        drift = machine.drifts.get(sweep.id)
        parts = [f"commit {(sweep.commit or 'unknown')[:12]}", f"harness {sweep.version}"]
        parts += [f"drift of the machine since the first {drift:.3g}"] if drift is not None and earlier else []
        say(f"  sweep {sweep.id}, {sweep.started}: {', '.join([*parts, *package_changes(sweep, earlier)])}")
        earlier = sweep
    unit = METRICS[metric].unit
    for point in machine.points:
        if point.steps or everything:
            course = ", ".join(f"{number}: {quantity(found.median, unit)}" for number, found in point.values.items())
            say(f"{point.experiment or 'no longer listed'}{f' ({point.label})' if point.label else ''}: {course}")
        for step in point.steps:
            say(
                f"  {_change(step.ratio, clock=METRICS[metric].clock)} from sweep {step.sweep.id} on; commit "
                f"{(step.before.commit or 'unknown')[:12]} to {(step.sweep.commit or 'unknown')[:12]}"
            )
    long = sum(len(point.values) >= FEWEST_SWEEPS for point in machine.points)
    count = sum(len(point.steps) for point in machine.points)
    say(
        f"{plural(len(machine.points), 'point')} over {plural(len(machine.sweeps), 'sweep')}, {long} of them measured "
        f"by {FEWEST_SWEEPS} sweeps or more, as a step needs: {plural(count, 'step')}".replace("\u00a0", " ")
    )


def _change(ratio: float, *, clock: bool) -> str:
    if not clock:
        return f"{ratio:.3g} times as much"
    return f"{ratio:.3g} times as long" if ratio > 1.0 else f"{1.0 / ratio:.3g} times as fast"


def _document(machine: MachineHistory) -> dict[str, Any]:
    return {
        "machine": machine.fingerprint,
        "facts": dict(machine.facts),
        "sweeps": [
            {
                "sweep": sweep.id,
                "started": sweep.started,
                "commit": sweep.commit,
                "version": sweep.version,
                "packages": dict(sweep.packages),
                "drift": machine.drifts.get(sweep.id),
            }
            for sweep in machine.sweeps
        ],
        "points": [
            {
                "experiment": point.experiment or None,
                "parameters": dict(point.parameters),
                "values": [{"sweep": number, **_summary(found)} for number, found in point.values.items()],
                "steps": [
                    {
                        "sweep": step.sweep.id,
                        "before": step.before.id,
                        "commits": [step.before.commit, step.sweep.commit],
                        "ratio": step.ratio,
                        "p_value": step.p_value,
                    }
                    for step in point.steps
                ],
            }
            for point in machine.points
        ],
    }


def _summary(found: Summary) -> dict[str, Any]:
    return {
        "median": found.median, "low": found.low, "high": found.high, "repeats": found.n,
    }  # fmt: skip
