"""`harness COMMAND`: finds the command's file, which parses, calls and prints. Nothing heavy is imported here."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module

from harness.errors import InputError

COMMANDS = {
    "sweep": "run experiments and keep every measurement",
    "report": "turn the measurements into pages",
    "diff": "compare two sweeps: what got slower, what changed",
    "compare": "hold backends against each other and against exact arithmetic",
    "trace": "print the hits of one run",
    "plan": "print what each run does, what it leaves out, and why",
    "view": "replay a run in the browser, or try settings live",
    "validate": "check experiment files and say every error",
    "list": "print experiments, backends, algorithms and metrics",
    "export": "print the measurements as CSV or JSON",
    "mesh": "make, inspect and simplify mesh files",
    "new": "write a commented experiment to start from",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line.

    Returns
    -------
    int
        Exit code: 0 done, 1 an expectation or a run failed, 2 the input was wrong, 130 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    parser = _parser()
    if not words or words[0] not in COMMANDS:
        parser.parse_args(words)
        parser.print_help()
        return 0 if words else 2
    name = words[0]
    module = import_module(f"harness.cli.{name}")
    command = argparse.ArgumentParser(
        prog=f"harness {name}", description=module.__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    module.add_arguments(command)
    try:
        return int(module.run(command.parse_args(words[1:])))
    except InputError as error:
        for problem in error.problems:
            print(problem, file=sys.stderr)
        return 2
    except BrokenPipeError:
        # the reader has gone (`harness export | head`); nothing is left to say, not even at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    width = max(map(len, COMMANDS))
    lines = "\n".join(f"  {name:{width}}  {what}" for name, what in COMMANDS.items())
    parser = argparse.ArgumentParser(
        prog="harness",
        description="A laboratory for collision detection: which pipeline, for my scene, at the accuracy I need?",
        epilog=f"commands:\n{lines}\n\n`harness COMMAND --help` says more.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        usage="harness COMMAND …",
    )
    parser.add_argument("command", nargs="?", choices=COMMANDS, help=argparse.SUPPRESS)
    return parser


if __name__ == "__main__":
    sys.exit(main())
