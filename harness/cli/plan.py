"""Print what each run does, which stages it leaves out, and why."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from harness.cli.overrides import add_override_argument, overrides_of
from harness.cli.width import say
from harness.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from harness.experiment.experiment import Experiment, Point
    from harness.scene.scene_files import Opened

# Of runs whose plans are kept: those of more take megabytes.
_MOST_KEPT = 1000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="PATH", help="an experiment file")
    add_override_argument(parser)
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    import json
    import sys
    from pathlib import Path

    from harness.experiment.kept_facts import kept_facts

    overrides = overrides_of(arguments)
    planned = kept_facts("plan", Path(arguments.path), overrides) or _planned(arguments.path, overrides)
    passed_over = [f"points passed over: {why}" for why in planned.get("lacking", ())]
    if arguments.json:
        json.dump({"runs": planned["runs"]}, sys.stdout, allow_nan=False)
        print()
        for line in passed_over:
            print(line, file=sys.stderr)
        return 0
    _show(planned)
    for line in passed_over:
        say(line)
    return 0


def _planned(path: str, overrides: dict[str, str]) -> dict[str, Any]:
    """The title of an experiment, its leaves that vary, and its runs with their plans; they are kept.

    Points whose backend is an extra that is not installed are passed over, as in a sweep; `lacking` says why.

    Raises
    ------
    InputError
        With everything that is wrong with it.
    """
    from pathlib import Path

    from harness.backends.registry import ours
    from harness.backends.statement import missing
    from harness.experiment.kept_facts import keep_facts
    from harness.runner.preparation import prepare

    experiments, meshes = prepare([path], overrides)
    experiment = experiments[0]
    backends = dict.fromkeys(point.engine.backend for point in experiment.points)
    lacking = {name: why for name in backends if (why := missing(name)) is not None}
    points = [point for point in experiment.points if point.engine.backend not in lacking]
    runs = _runs(experiment, points, meshes)
    planned = {"title": experiment.title, "swept": list(experiment.swept), "runs": runs, "lacking": [*lacking.values()]}
    plugins = {point.engine.backend for point in experiment.points if not ours(point.engine.backend)}
    if experiment.path == Path(path) and len(runs) <= _MOST_KEPT and not plugins:
        of_file = experiment.source, experiment.mesh_paths, experiment.poses_paths
        keep_facts("plan", experiment.path, overrides, *of_file, planned)
    return planned


def _runs(experiment: Experiment, points: Sequence[Point], meshes: Opened) -> list[dict[str, Any]]:
    """What each point does; the bodies of points of one scene are placed once, and one scene is held at a time."""
    from dataclasses import asdict

    from harness.runner.point import plan_of
    from harness.runner.scene_of_point import SceneSizeError, build_scene
    from harness.runner.servers import files_of
    from harness.scene.launch import PlacementError

    places_of_scene: dict[str, list[int]] = {}
    for place, point in enumerate(points):
        places_of_scene.setdefault(repr((point.scene, point.motion.poses)), []).append(place)
    runs: dict[int, dict[str, Any]] = {}
    for places in places_of_scene.values():
        first = points[places[0]]
        try:
            scene = build_scene(first, files_of(experiment, first, meshes), experiment.measure.memory)
        except (SceneSizeError, PlacementError) as error:
            leaf = "count" if first.scene.bodies is None else "bodies"
            raise InputError([experiment.leaf_problem(leaf, first.parameters[leaf], str(error))]) from error
        for place in places:
            plan = plan_of(points[place], scene)
            stages = [asdict(stage) for stage in plan.stages]
            parameters = points[place].parameters
            runs[place] = {"parameters": parameters, "stages": stages, "warnings": list(plan.warnings)}
    return [runs[place] for place in range(len(points))]


def _show(planned: Mapping[str, Any]) -> None:
    """One table for all points that have the same plan."""
    console = _terminal()
    for runs in _alike(planned["runs"]):
        first = runs[0]
        title = f"{planned['title']}{_named(planned['swept'], runs)}"
        _print(console, title, "bold")
        for warning in first["warnings"]:
            _print(console, f"  WARNING   {warning}", "bold red")
        if console is None:
            for stage in first["stages"]:
                say(f"  {_decision(stage):10}  {stage['name']:13}  {stage['why']}")
        else:
            _print_table(console, first["stages"])


def _terminal() -> Console | None:
    """What prints in colours, where standard output is a terminal or a variable says so."""
    import os
    import sys

    # of a library that only a terminal is worth waiting for, which looks at these variables besides
    if not sys.stdout.isatty() and not {"FORCE_COLOR", "TTY_COMPATIBLE"} & os.environ.keys():
        return None
    from rich.console import Console

    console = Console(highlight=False)
    return console if console.is_terminal else None


def _print(console: Console | None, text: str, style: str) -> None:
    if console is None:
        say(text)
        return
    from rich.text import Text

    console.print(Text(text, style))


def _print_table(console: Console, stages: Sequence[Mapping[str, Any]]) -> None:
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 2, 0, 0))
    for stage in stages:
        style = "" if stage["kept"] else "dim"
        decision = Text(_decision(stage), "green" if stage["kept"] else "yellow")
        table.add_row("", decision, Text(stage["name"], f"bold {style}"), Text(stage["why"], style))
    console.print(table)


def _decision(stage: Mapping[str, Any]) -> str:
    return "keeps" if stage["kept"] else "leaves out"


def _alike(runs: Sequence[dict[str, Any]]) -> Iterable[list[dict[str, Any]]]:
    """The runs of each plan, in the order of its first."""
    import json

    alike: dict[str, list[dict[str, Any]]] = {}
    for run in runs:
        alike.setdefault(json.dumps([run["stages"], run["warnings"]]), []).append(run)
    return alike.values()


def _named(swept: Sequence[str], runs: Sequence[Mapping[str, Any]]) -> str:
    """The points, by the values of the leaves that vary."""
    from harness.experiment.messages import flow

    varied = [f"{leaf} {', '.join(dict.fromkeys(flow(run['parameters'][leaf]) for run in runs))}" for leaf in swept]
    return f": {'; '.join(varied)}" if varied else ""
