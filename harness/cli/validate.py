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

    from harness.experiment.files import find_experiments, name_of
    from harness.experiment.kind import find_truth_declarations

    problems: list[Problem] = []
    lacking: list[Problem] = []
    truths = find_truth_declarations(arguments.paths)
    for path in truths:
        try:
            print(f"{path}: {_cases(path)}")
        except NotInstalledError as error:
            lacking += error.problems
        except InputError as error:
            problems += error.problems
    left = [path for path in arguments.paths if not _only_truths(Path(path), truths)]
    paths = find_experiments(left) if left else []
    overrides = overrides_of(arguments) if left else {}
    valid, found_lacking, found_problems = _examined(paths, overrides)
    for path in paths:
        if path in valid:
            print(f"{name_of(path)}: {valid[path]}")
    first = {(problem.file, problem.message): problem for problem in reversed([*lacking, *found_lacking])}
    for problem in reversed(first.values()):
        print(f"{problem}; what needs it is passed over")
    problems += found_problems
    if problems:
        raise InputError(problems)
    return 0


def _cases(path: Path) -> str:
    """What a valid declaration of cases comes to.

    Raises
    ------
    InputError
        With everything that is wrong with it.
    """
    from harness.experiment.kept_facts import keep_facts, kept_facts

    if (kept := kept_facts("validate", path, {})) is not None:
        return str(kept["valid"])
    from harness.truth.declaration import load_truth

    declaration = load_truth(path)
    count = sum(family.count for family in declaration.families.values())
    valid = f"a set of {count} cases in {len(declaration.families)} families"
    keep_facts("validate", path, {}, declaration.text, declaration.meshes, {}, {"valid": valid})
    return valid


def _examined(paths: list[Path], overrides: dict[str, str]) -> tuple[dict[Path, str], list[Problem], list[Problem]]:
    """What each valid experiment comes to, what others lack here, and what is wrong with the rest."""
    from harness.experiment.files import name_of
    from harness.experiment.kept_facts import keep_facts, kept_facts

    valid: dict[Path, str] = {}
    if len({name_of(path) for path in paths}) == len(paths):  # else one may be wrong because of another
        found = ((path, kept_facts("validate", path, overrides)) for path in paths)
        valid = {path: str(kept["valid"]) for path, kept in found if kept is not None}
    if len(valid) == len(paths):
        return valid, [], []
    from harness.backends.registry import ours
    from harness.runner.preparation import examine

    prepared = examine([path for path in paths if path not in valid], overrides)
    for experiment in prepared.experiments:
        points, runs = len(experiment.points), experiment.runs
        text = f"{points} point{'s' * (points != 1)}, {runs} run{'s' * (runs != 1)}"
        valid[experiment.path] = text
        if all(map(ours, {point.engine.backend for point in experiment.points})):  # a plugin is asked each time
            of_file = experiment.source, experiment.mesh_paths, experiment.poses_paths
            keep_facts("validate", experiment.path, overrides, *of_file, {"valid": text})
    return valid, prepared.lacking, prepared.problems


def _only_truths(path: Path, truths: list[Path]) -> bool:
    """Whether a path names sets of cases, and nothing else."""
    files = set(path.rglob("*.yaml")) if path.is_dir() else {path}
    return bool(files) and files <= set(truths)
