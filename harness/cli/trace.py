"""Print the hits of one run: of the first point, where a file sweeps.

Stepped runs report the hits that were answered, at the time of their frame; with `response: none`, the onset of each
contact, at the first frame that sees it.

With `engine.query: distance` or `tolerance` an event is that a pair comes near, with its gap (m) where that is asked;
with `impact` that it begins to touch, at its exact time. --json has every answer in full: `near` (frame, time, bodies,
gap, points) or `impacts` (time, bodies).

With --json or --csv also the state of each body of an event: its position (m), its velocity before and after (m/s), and
the impulse that it received (kg m/s). With `response: none`, a wall turns the component along its normal, whatever
other walls were met in that frame.
"""

from __future__ import annotations

import argparse

from harness.cli.overrides import add_override_argument, overrides_of
from harness.cli.width import say


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="PATH", help="an experiment file")
    add_override_argument(parser)
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="one JSON document on standard output")
    form.add_argument("--csv", action="store_true", help="a row a hit on standard output")


def run(arguments: argparse.Namespace) -> int:
    import json
    import sys

    from harness.runner.preparation import prepare
    from harness.runner.sweep import RunError, trace
    from harness.vocabulary import WALLS

    experiments, meshes = prepare([arguments.path], overrides_of(arguments))
    try:
        traced = trace(experiments[0], meshes)
    except RunError as failure:
        print(f"{arguments.path}: the run failed ({failure.report.status}): {failure.report.reason}", file=sys.stderr)
        return 1
    if arguments.json:
        json.dump(traced.to_json(), sys.stdout, allow_nan=False)
        print()
        return 0
    if arguments.csv:
        sys.stdout.write(traced.to_csv())
        return 0
    events = zip(traced.times.tolist(), traced.bodies.tolist(), traced.walls.tolist(), traced.gaps, strict=True)
    for time, (i, j), wall, gap in events:
        near = " are near" if traced.near else " begin to touch" if traced.query == "impact" else ""
        near += "" if gap is None else f", {gap:.9g} m apart"
        what = f"bodies {i} and {j}{near}" if wall < 0 else f"body {i} and wall {WALLS[wall]}"
        say(f"{time:.9g} s  {what}")
    counters = "  ".join(f"{name} {value}" for name, value in traced.counters.items())
    if traced.answers is not None and len(traced.answers.frames):
        frames, gaps = len(set(traced.answers.frames.tolist())), traced.answers.gaps
        least = f", the least gap {gaps.min():.9g} m" if traced.query == "distance" else ""
        say(f"{len(gaps)} answers in {frames} frames: a pair that is near at a frame{least}")
    kind = "events" if traced.near else "hits"
    say(f"{len(traced.times)} {kind} in {traced.time:g} s; energy {traced.energy:.15g} J\n{counters}")
    return 0
