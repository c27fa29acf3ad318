"""Print what each run does, which stages it leaves out, and why."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from harness.cli.overrides import add_override_argument, overrides_of
from harness.cli.width import say
from harness.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

    from harness.experiment.experiment import Experiment, Point
    from harness.methods.stages import Plan


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="PATH", help="an experiment file")
    add_override_argument(parser)
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    import json
    import sys
    from dataclasses import asdict

    from harness.runner.point import plan_of
    from harness.runner.preparation import prepare
    from harness.runner.scene_of_point import SceneSizeError, build_scene
    from harness.runner.servers import files_of
    from harness.scene.launch import PlacementError

    experiments, meshes = prepare([arguments.path], overrides_of(arguments))
    experiment = experiments[0]
    plans = []
    for point in experiment.points:
        try:
            scene = build_scene(point, files_of(experiment, point, meshes), experiment.measure.memory)
        except (SceneSizeError, PlacementError) as error:
            leaf = "count" if point.scene.bodies is None else "bodies"
            raise InputError([experiment.leaf_problem(leaf, point.parameters[leaf], str(error))]) from error
        plans.append((point, plan_of(point, scene)))
    if arguments.json:
        runs = [
            {
                "parameters": point.parameters,
                "stages": [asdict(stage) for stage in plan.stages],
                "warnings": list(plan.warnings),
            }
            for point, plan in plans
        ]
        json.dump({"runs": runs}, sys.stdout, allow_nan=False)
        print()
        return 0
    _show(experiment, plans)
    return 0


def _show(experiment: Experiment, plans: Sequence[tuple[Point, Plan]]) -> None:
    """One table for all points that have the same plan."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    for plan, points in _alike(plans):
        title = f"{experiment.title}{_named(experiment, points)}"
        _print(console, Text(title, "bold"))
        for warning in plan.warnings:
            _print(console, Text(f"  WARNING   {warning}", "bold red"))
        table = Table.grid(padding=(0, 2, 0, 0))
        for stage in plan.stages:
            decision = "keeps" if stage.kept else "leaves out"
            if console.is_terminal:
                style = "" if stage.kept else "dim"
                shown = Text(decision, "green" if stage.kept else "yellow"), Text(stage.name, f"bold {style}")
                table.add_row("", *shown, Text(stage.why, style))
            else:
                say(f"  {decision:10}  {stage.name:13}  {stage.why}")
        if console.is_terminal:
            console.print(table)


def _print(console: Console, text: Text) -> None:
    if console.is_terminal:
        console.print(text)
    else:
        say(text.plain)


def _alike(plans: Sequence[tuple[Point, Plan]]) -> Iterable[tuple[Plan, list[Point]]]:
    """Each plan once, with all of its points, in the order of its first."""
    points: dict[Plan, list[Point]] = {}
    for point, plan in plans:
        points.setdefault(plan, []).append(point)
    return points.items()


def _named(experiment: Experiment, points: Sequence[Point]) -> str:
    """The points, by the values of the leaves that vary."""
    from harness.experiment.messages import flow

    varied = [
        f"{leaf} {', '.join(dict.fromkeys(flow(point.parameters[leaf]) for point in points))}"
        for leaf in experiment.swept
    ]
    return f": {'; '.join(varied)}" if varied else ""
