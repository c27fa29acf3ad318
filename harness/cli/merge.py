"""Bring the results of several machines, or of several files of one, together in the first file.

Every sweep and run of the others is added to it, once: the same command again changes nothing. The others are only
read. Numbers of two machines are never mixed: of a point that several have measured, pages and exports show the runs of
the machine that measured it last, and `harness history` shows each machine by itself.
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("into", metavar="FILE", type=Path, help="the results that are added to")
    parser.add_argument("others", metavar="OTHER", type=Path, nargs="+", help="results that are added")


def run(arguments: argparse.Namespace) -> int:
    from harness.store.merging import merge

    merged = merge(arguments.into, arguments.others)
    (sweeps, all_sweeps), (runs, all_runs), (_, all_machines) = merged.sweeps, merged.runs, merged.machines
    print(
        f"{arguments.into}: {_counted(all_sweeps - sweeps, 'sweep')} and {_counted(all_runs - runs, 'run')} added; "
        f"now {_counted(all_sweeps, 'sweep')} and {_counted(all_runs, 'run')} of {_counted(all_machines, 'machine')}"
    )
    return 0


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun if count == 1 else noun + 's'}"
