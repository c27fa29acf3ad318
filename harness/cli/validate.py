"""Check experiment files and declarations of truth sets, and say everything that is wrong with them."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from harness.cli.overrides import add_override_argument, overrides_of
from harness.errors import InputError, NotInstalledError, Problem

if TYPE_CHECKING:
    from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument("paths", metavar="PATH", nargs="+", help="experiment files, or folders of them")
    add_override_argument(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print a line for every valid file; the problems of the others are raised together."""
    from pathlib import Path

    from harness.experiment.kind import find_truth_declarations
    from harness.runner.preparation import Prepared, examine
    from harness.truth.declaration import load_truth

    problems: list[Problem] = []
    lacking: list[Problem] = []
    truths = find_truth_declarations(arguments.paths)
    for path in truths:
        try:
            declaration = load_truth(path)
        except NotInstalledError as error:
            lacking += error.problems
        except InputError as error:
            problems += error.problems
        else:
            count = sum(family.count for family in declaration.families.values())
            print(f"{path}: a set of {count} cases in {len(declaration.families)} families")
    left = [path for path in arguments.paths if not _only_truths(Path(path), truths)]
    found = examine(left, overrides_of(arguments)) if left else Prepared([], {}, [], [])
    for experiment in found.experiments:
        points, runs = len(experiment.points), experiment.runs
        print(f"{experiment.name}: {points} point{'s' * (points != 1)}, {runs} run{'s' * (runs != 1)}")
    first = {(problem.file, problem.message): problem for problem in reversed([*lacking, *found.lacking])}
    for problem in reversed(first.values()):
        print(f"{problem}; what needs it is passed over")
    problems += found.problems
    if problems:
        raise InputError(problems)
    return 0


def _only_truths(path: Path, truths: list[Path]) -> bool:
    """Whether a path names sets of cases, and nothing else."""
    files = set(path.rglob("*.yaml")) if path.is_dir() else {path}
    return bool(files) and files <= set(truths)
