"""Make and check sets of cases with proven times of impact.

`make` draws pairs of spinning bodies as a file declares them, and proves of each when they begin to touch; `check`
proves every row of such a set anew, and exits 1 if one fails.
"""

from __future__ import annotations

import argparse

DEFAULT_BUDGET = 7200.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="make|check")
    make = actions.add_parser("make", help="draw cases and prove them", description="Draw cases and prove them.")
    make.add_argument("file", metavar="FILE", help="a declaration, such as experiments/truth/spinning.yaml")
    make.add_argument("--out", metavar="DIR", required=True, help="the folder to write")
    make.add_argument(
        "--budget",
        metavar="SECONDS",
        type=float,
        default=DEFAULT_BUDGET,
        help="draw no more after so long; the README says how many were made (default: 7200)",
    )
    check = actions.add_parser("check", help="prove every case anew", description="Prove every case anew.")
    check.add_argument("folder", metavar="DIR", help="a folder that `make` wrote")


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked for; tells by the exit code whether everything holds."""
    return _make(arguments) if arguments.action == "make" else _check(arguments)


def _make(arguments: argparse.Namespace) -> int:
    from pathlib import Path

    from harness.errors import InputError
    from harness.scene.mesh_child import open_meshes
    from harness.truth.declaration import load_truth
    from harness.truth.folder import write_set
    from harness.truth.make import make
    from harness.truth.proof import WIDEST
    from harness.truth.readme import readme

    declaration = load_truth(Path(arguments.file))
    opened = open_meshes(list(declaration.meshes.values()))
    meshes = {path: mesh for path, mesh in opened.items() if not isinstance(mesh, str)}
    if broken := [mesh for mesh in opened.values() if isinstance(mesh, str)]:
        raise InputError("\n".join(broken))
    made = make(declaration, meshes, arguments.budget, _progress)
    cases, left_out = made.all(), sum(made.left_out.values())
    text = readme(declaration, cases, left_out, made.moved, WIDEST)
    write_set(Path(arguments.out), cases, made.solids, made.surfaces, text)
    asked = sum(family.count for family in declaration.families.values())
    print(f"{arguments.out}: {cases.number} of {asked} cases, {left_out} drafts left out")
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from pathlib import Path

    from harness.truth.check import check
    from harness.truth.folder import read_set

    given = read_set(Path(arguments.folder))
    problems = check(given, _progress)
    for problem in problems:
        print(problem)
    print(f"{given.cases.number - len(problems)} of {given.cases.number} cases are proven")
    return 1 if problems else 0


def _progress(line: str) -> None:
    import sys

    print(line, file=sys.stderr)
