"""`harness report`: turn the results into pages."""

from __future__ import annotations

import argparse

from harness import DATABASE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say which results, and where the pages go."""
    parser.add_argument("--db", metavar="FILE", default=DATABASE, help="the results (default: %(default)s)")
    parser.add_argument(
        "--out", metavar="DIR", default="results/report", help="folder to write the pages into (default: %(default)s)"
    )
    parser.add_argument(
        "--figures",
        action="append",
        choices=["pdf", "png"],
        default=[],
        help="write figures in this format, too, beside their SVG; can be given again",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the pages, and say where the first one is."""
    from harness.report.site import write_report

    print(write_report(arguments.db, arguments.out, tuple(dict.fromkeys(arguments.figures))))
    return 0
