"""Print what each run does, which stages it leaves out, and why."""

from __future__ import annotations

import argparse

from harness.cli.overrides import add_override_argument, overrides_of
from harness.errors import InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="PATH", help="an experiment file")
    add_override_argument(parser)
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    import json
    import sys
    from dataclasses import asdict

    from harness.runner.execute import plan_of
    from harness.runner.preparation import prepare
    from harness.runner.servers import mesh_of
    from harness.runner.setting import SceneSizeError, build_scene
    from harness.scene.launch import PlacementError

    experiments, meshes = prepare([arguments.path], overrides_of(arguments))
    experiment = experiments[0]
    try:
        plans = [
            (point, plan_of(point, build_scene(point, mesh_of(experiment, point, meshes), experiment.measure.memory)))
            for point in experiment.points
        ]
    except (SceneSizeError, PlacementError) as error:
        raise InputError(f"{arguments.path}: {error}") from error
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
    for point, plan in plans:
        varied = ", ".join(f"{leaf} {point.parameters[leaf]}" for leaf in experiment.swept)
        print(f"{experiment.title}{': ' if varied else ''}{varied}")
        for warning in plan.warnings:
            print(f"  WARNING   {warning}")
        for stage in plan.stages:
            print(f"  {'keeps' if stage.kept else 'leaves out':10}  {stage.name:13}  {stage.why}")
    return 0
