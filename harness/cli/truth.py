"""Make and check sets of cases with proven times of impact, and ask engines about them.

`make` draws pairs of spinning bodies as a file declares them, and proves of each when they begin to touch; `check`
proves every row of such a set anew, and exits 1 if one fails; `ask` tells which engines are right, and which miss a
touch or tell it late.
"""

from __future__ import annotations

import argparse
from typing import Any

from harness.cli.arguments import comma_separated, positive_count, positive_seconds
from harness.cli.width import HelpFormatter

DEFAULT_BUDGET = 7200.0

_ASKED = """\
Ask engines when the pairs of a set begin to touch, and count their answers, by family: right, missed (a pair that
touches, told to be none), late, early (the safe side), false (one that never touches, told to), failed (an error, a
crash, or no answer in time). "latest" and "earliest" are the most that a time was out of its bounds.

Right is from `lower` to `upper`, give or take --within; or what the engine cannot tell apart: an answer a time d
outside of the bounds is right, too, if d before `lower` the bodies were no farther apart than the engine's own
tolerance, which for `own` is 1e-12 of the mean size, and for a backend what `harness list` says. The same goes for a
pair that never touches and is told to, at the time that is told. That gap is measured by harness.distance,
whose rounding, 1e-14 of the mean size, is allowed besides.

NAMES:
  own              this program's engine, harness.time_of_impact
  fcl, rapier3d    a backend that says itself when bodies meet, as in `engine.query: impact`
  fcl/brute-force  a backend's test of whether bodies touch, frame by frame at each --dt: the time is that of the
                   first frame in which they do; so is a backend that does not say when

Where a pair touches at the start, 0 is right. Backends that say when need not report such a pair: if they are silent
about a pair, their own test at the start decides whether that means 0 or never.
Times a query are CPU time, the median; loading is not in them. Of a stepped backend all frames are one query.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="make|check|ask")
    make = actions.add_parser("make", help="draw cases and prove them", description="Draw cases and prove them.")
    make.add_argument("file", metavar="FILE", help="a declaration, such as experiments/truth/spinning.yaml")
    make.add_argument("--out", metavar="DIR", required=True, help="the folder to write")
    make.add_argument(
        "--budget",
        metavar="SECONDS",
        type=float,
        default=DEFAULT_BUDGET,
        help=f"draw no more after so long; the README says how many were made (default: {DEFAULT_BUDGET:g})",
    )
    check = actions.add_parser("check", help="prove every case anew", description="Prove every case anew.")
    check.add_argument("folder", metavar="DIR", help="a folder that `make` wrote")
    ask = actions.add_parser(
        "ask",
        help="ask engines about the cases",
        description=_ASKED,
        formatter_class=HelpFormatter,
    )
    ask.add_argument("folder", metavar="DIR", help="a folder that `make` wrote")
    ask.add_argument(
        "--backends", metavar="NAMES", type=comma_separated, default=["own"], help="such as own,fcl (default: own)"
    )
    ask.add_argument("--families", metavar="NAMES", type=comma_separated, default=[], help="ask about these alone")
    ask.add_argument(
        "--every", metavar="N", type=positive_count, default=1, help="ask about every N-th case of each family"
    )
    ask.add_argument(
        "--dt",
        metavar="SECONDS",
        type=_steps,
        default="1/60,1/1000",
        help="steps of what is stepped (default: 1/60,1/1000)",
    )
    ask.add_argument(
        "--within",
        metavar="SECONDS",
        type=positive_seconds,
        default="1e-9",
        help="by which a time may be out of its bounds (default: 1e-9)",
    )
    ask.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=positive_seconds,
        default="60",
        help="that a case may take; its process is then ended (default: 60)",
    )
    ask.add_argument("--db", metavar="FILE", help="keep the answers in a database, for `harness report` to show")
    ask.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    """Do what was asked for; tells by the exit code whether everything holds."""
    return {"make": _make, "check": _check, "ask": _ask}[arguments.action](arguments)


def _make(arguments: argparse.Namespace) -> int:
    from pathlib import Path

    from harness.errors import InputError
    from harness.scene.mesh_child import open_meshes
    from harness.truth.declaration import load_truth
    from harness.truth.folder import write_set
    from harness.truth.make import make
    from harness.truth.proof import WIDEST
    from harness.truth.readme import readme
    from harness.whole_file import require_writable

    declaration = load_truth(Path(arguments.file))
    try:
        require_writable(Path(arguments.out))  # before the work, not after it
    except OSError as error:
        raise _unwritable(arguments.out, error) from error
    opened = open_meshes(list(declaration.meshes.values()))
    meshes = {path: mesh for path, mesh in opened.items() if not isinstance(mesh, str)}
    if broken := [mesh for mesh in opened.values() if isinstance(mesh, str)]:
        raise InputError("\n".join(broken))
    made = make(declaration, meshes, arguments.budget, _progress)
    cases, left_out = made.all(), sum(made.left_out.values())
    text = readme(declaration, cases, left_out, made.moved, WIDEST)
    try:
        write_set(Path(arguments.out), cases, made.solids, made.surfaces, text)
    except OSError as error:
        raise _unwritable(arguments.out, error) from error
    asked = sum(family.count for family in declaration.families.values())
    print(f"{arguments.out}: {cases.number} of {asked} cases, {left_out} drafts left out")
    return 0


def _unwritable(out: str, error: OSError) -> Exception:
    from harness.errors import InputError

    return InputError(f"{error.filename or out}: cannot be written: {error.strerror}; give another folder with --out")


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


def _ask(arguments: argparse.Namespace) -> int:
    import json
    from pathlib import Path

    from harness.errors import InputError
    from harness.truth.answer_table import document, documents, table
    from harness.truth.answerers import asked_engines
    from harness.truth.ask import ask, chosen
    from harness.truth.folder import read_set

    asked_of = asked_engines(arguments.backends, arguments.dt)
    if arguments.db is not None:
        _open(arguments.db).close()  # before the work, not after it
    given = read_set(Path(arguments.folder))
    there = dict.fromkeys(given.cases.families.tolist())
    if unknown := [name for name in arguments.families if name not in there]:
        raise InputError(f"there is no family {', '.join(unknown)} in the set; there are {', '.join(there)}")
    rows = chosen(given, arguments.families, arguments.every)
    asked = {
        question: ask(given, question, rows, arguments.within, arguments.timeout, _progress)
        for question in dict.fromkeys(asked_of)
    }
    if arguments.db is not None:
        _keep(documents(asked, arguments.folder, arguments.within, arguments.every), arguments.folder, arguments.db)
    if arguments.json:
        print(json.dumps(document(asked, arguments.folder, arguments.within, arguments.every), allow_nan=False))
    else:
        print(table(asked))
    return 0


def _open(path: str) -> Any:
    from harness.store.database import Database

    return Database.open(path)


def _keep(found: dict[str, dict[str, Any]], folder: str, database: str) -> None:
    """Each answerer's answers, in place of earlier ones of it about a set of this name."""
    import shlex
    import sys
    from pathlib import Path

    path = Path(folder).resolve()
    name = f"{path.parent.name}/{path.name}"
    with _open(database) as kept:
        for label, told in found.items():
            command = shlex.join(["harness", *sys.argv[1:]])
            kept.add_comparison(command, name, (label, "proven times"), f"{name} {label}", told)


def _steps(text: str) -> list[float]:
    return [positive_seconds(word) for word in comma_separated(text)]


def _progress(line: str) -> None:
    import sys

    print(line, file=sys.stderr)
