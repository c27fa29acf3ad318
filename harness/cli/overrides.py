"""`--set leaf=value`, as every command that reads experiments takes it."""

from __future__ import annotations

import argparse

from harness.errors import InputError, Problem


def add_override_argument(parser: argparse.ArgumentParser) -> None:
    """Give a command `--set leaf=value`."""
    parser.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="LEAF=VALUE",
        help="a leaf in the place of the file's, such as count=50, dt=1/120 or count=[5, 10]; can be given again",
    )


def overrides_of(arguments: argparse.Namespace) -> dict[str, str]:
    """The leaves that `--set` gives, each with its text."""
    overrides: dict[str, str] = {}
    problems = []
    for text in arguments.overrides:
        leaf, equals, value = text.partition("=")
        if equals and leaf.strip():
            overrides[leaf.strip()] = value
        else:
            problems.append(Problem(f"--set {text}: must be LEAF=VALUE, such as count=50"))
    if problems:
        raise InputError(problems)
    return overrides
