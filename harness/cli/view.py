"""Replay a run in the browser: of the first point, where a file sweeps.

With --live, a page on this machine on which count, box ratio, speed, algorithm, backend and shape can be changed: each
change is run at once and shown, and its hits and costs are listed.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.overrides import add_override_argument, overrides_of
from harness.errors import InputError

if TYPE_CHECKING:
    from harness.experiment.experiment import Experiment

REPLAYS = Path("results/replays")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="PATH", help="an experiment file")
    add_override_argument(parser)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--out", metavar="FILE", help=f"write the page there, and open nothing (else below {REPLAYS}/)")
    how.add_argument("--live", action="store_true", help="serve a page on which settings can be changed, until Ctrl-C")


def run(arguments: argparse.Namespace) -> int:
    import sys

    from harness.replay.page import replay_page
    from harness.runner.preparation import prepare
    from harness.runner.servers import Servers, task_of
    from harness.whole_file import write_whole

    experiments, meshes = prepare([arguments.path], overrides_of(arguments))
    experiment = experiments[0]
    if arguments.live:
        from harness.cli.live import serve

        return serve(experiment, meshes, _open)
    path = Path(arguments.out) if arguments.out else REPLAYS / f"{experiment.name}.html"
    with _writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    with Servers() as servers:
        report = servers.run(*task_of(experiment, experiment.points[0], meshes, recorded=True))
    if report.recording is None:
        print(f"{arguments.path}: the run failed ({report.status}): {report.reason}", file=sys.stderr)
        return 1
    page = replay_page(report.recording, experiment.title, _facts(experiment, report.metrics))
    with _writing(path):
        write_whole(path, page)
    print(path)
    if not arguments.out:
        _open(path.absolute().as_uri())
    return 0


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}; give another file with --out") from error


def _facts(experiment: Experiment, metrics: dict[str, float]) -> list[tuple[str, str]]:
    from harness.replay.facts import facts

    return facts(experiment.points[0].parameters, metrics)


def _open(address: str) -> None:
    """Show an address in the browser, where there is a screen; a browser in the terminal would take it over."""
    import os
    import sys
    import webbrowser

    if sys.platform != "linux" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        webbrowser.open(address)
