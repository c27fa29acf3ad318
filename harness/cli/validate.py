"""Check experiment files, and say everything that is wrong with them."""

from __future__ import annotations

import argparse

from harness.cli.overrides import add_override_argument, overrides_of
from harness.errors import InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument("paths", metavar="PATH", nargs="+", help="experiment files, or folders of them")
    add_override_argument(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print a line for every valid experiment; the problems of the others are raised together."""
    from harness.runner.preparation import examine

    experiments, _, problems = examine(arguments.paths, overrides_of(arguments))
    for experiment in experiments:
        points, runs = len(experiment.points), experiment.runs
        print(f"{experiment.name}: {points} point{'s' * (points != 1)}, {runs} run{'s' * (runs != 1)}")
    if problems:
        raise InputError(problems)
    return 0
