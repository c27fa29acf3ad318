"""`harness COMMAND`: finds the command's file, which parses, calls and prints. Nothing heavy is imported here."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from harness.cli.interruption import exit_code, heeding_signals
from harness.cli.streams import reliable_streams
from harness.cli.width import HelpFormatter, one_line
from harness.errors import InputError
from harness.process_limits import has_room_for_libraries, out_of_memory

COMMANDS = {
    "sweep": "run experiments and keep every measurement",
    "report": "turn the measurements into pages",
    "diff": "compare two sweeps: what got slower, what changed",
    "history": "a measurement over all sweeps, and where it changed for good",
    "merge": "bring results of several machines together",
    "compare": "compare backends with each other and with exact arithmetic",
    "trace": "print the hits of one run",
    "plan": "print what each run does, what it leaves out, and why",
    "view": "replay a run in the browser, or try settings live",
    "validate": "check experiment files and say every error",
    "list": "print experiments, backends, algorithms and metrics",
    "export": "print the measurements as CSV or JSON",
    "truth": "make and check cases with proven times of impact",
    "mesh": "make, inspect and simplify mesh files",
    "new": "write a commented experiment to start from",
}

_LIGHT = frozenset({"validate", "list", "new"})
"""Commands that do without scipy, whose linear algebra waits for memory for ever."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line.

    Returns
    -------
    int
        Exit code: 0 done, 1 an expectation or a run failed, 2 the input was wrong, 130 or 143 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    if arguments is not None:
        with heeding_signals():
            return _run(words)
    # the process is ours: so are its streams
    with reliable_streams() as output:
        with heeding_signals(last=True):
            try:
                code = _run(words)
            except SystemExit as ended:  # of the parser: 0 after --help, 2 where it was not understood
                code = int(ended.code or 0)
        output.flush()
        if output.lost is None or isinstance(output.lost, BrokenPipeError):
            return code  # that a reader has gone (`harness export | head`) changes nothing
        print(f"standard output took no more: {output.lost.strerror}", file=sys.stderr)
        return code or 1


def _run(words: Sequence[str]) -> int:
    try:
        parser = _parser()
        if not words or words[0] not in COMMANDS:
            parser.parse_args(words)
            parser.print_help()
            return 0 if words else 2
        name = words[0]
        if name not in _LIGHT and not has_room_for_libraries():
            raise MemoryError
        module = import_module(f"harness.cli.{name}")
        command = argparse.ArgumentParser(
            prog=f"harness {name}", description=module.__doc__, formatter_class=HelpFormatter
        )
        module.add_arguments(command)
        return int(module.run(command.parse_args(words[1:])))
    except InputError as error:
        for problem in error.problems:
            print(one_line(str(problem)), file=sys.stderr)
        return 2
    except KeyboardInterrupt as interruption:
        print("interrupted", file=sys.stderr)
        return exit_code(interruption)
    except (MemoryError, ImportError, OSError) as error:
        if not out_of_memory(error):
            raise
        print("memory ran out: this process may take less than the command needs (`ulimit -v`)", file=sys.stderr)
        return 1


def _parser() -> argparse.ArgumentParser:
    width = max(map(len, COMMANDS))
    lines = "\n".join(f"  {name:{width}}  {what}" for name, what in COMMANDS.items())
    parser = argparse.ArgumentParser(
        prog="harness",
        description="A laboratory for collision detection: which pipeline, for my scene, at the accuracy I need?",
        epilog=f"commands:\n{lines}\n\n`harness COMMAND --help` says more.",
        formatter_class=HelpFormatter,
        usage="harness COMMAND …",
    )
    parser.add_argument("command", nargs="?", choices=COMMANDS, help=argparse.SUPPRESS)
    return parser


if __name__ == "__main__":
    sys.exit(main())
