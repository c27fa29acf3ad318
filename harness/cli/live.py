"""`harness view --live`: the first point of an experiment, with inputs that a person changes on a page."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import yaml

from harness.backends import registry
from harness.cli.interruption import heed
from harness.errors import InputError
from harness.experiment.experiment import Experiment, Point
from harness.experiment.leaves import LEAVES, plain
from harness.experiment.load import load_text
from harness.replay.document import document
from harness.replay.live import LiveServer
from harness.replay.page import Input, live_page
from harness.runner.preparation import known_names
from harness.runner.scene_of_point import derived_parameters, mean_size
from harness.runner.servers import Servers, files_of, task_of
from harness.runner.task import Report
from harness.scene.scene_files import Opened, SceneFiles
from harness.vocabulary import ALGORITHMS

# Larger scenes are counted and timed, but not shown: a browser could not draw them smoothly.
MOST_BODIES = 5000
MOST_HITS = 200_000
COLUMNS = (
    "algorithm", "backend", "shape", "bodies", "box ratio", "speed", "body hits", "wall hits", "pair tests",
    "CPU time, ms", "simulated s per s",
)  # fmt: skip


def serve(experiment: Experiment, meshes: Opened, show: Callable[[str], None]) -> int:
    """Serve the live page until Ctrl-C, or SIGTERM.

    Parameters
    ----------
    experiment, meshes : loaded and opened; its first point is what the page begins with
    show : opens an address
    """
    heed(signal.SIGINT)  # also where a shell has started it in the background
    inputs = _inputs(experiment, meshes)
    with Servers() as servers:

        def answer(asked: Mapping[str, str]) -> Mapping[str, Any]:
            return _answer(experiment, meshes, servers, {one.name: one.value for one in inputs}, asked)

        with LiveServer(live_page(experiment.title, inputs, COLUMNS), answer) as server:
            print(f"{server.address}  (Ctrl-C stops it)", flush=True)
            show(server.address)
            with suppress(KeyboardInterrupt):
                server.serve_forever()
            servers.interrupt()  # a run that is in flight is not waited for
    return 0


def _inputs(experiment: Experiment, meshes: Opened) -> list[Input]:
    """The inputs of the page, with the values of the first point."""
    point = experiment.points[0]
    leaves = point.parameters
    files = files_of(experiment, point, meshes)
    shapes = ("sphere",) if not point.scene.mesh_names else ("sphere", "hull", "mesh")
    found = [
        Input("algorithm", "algorithm", leaves["algorithm"], tuple(ALGORITHMS)),
        Input("backend", "backend", leaves["backend"], tuple(registry.names())),
        Input("shape", "shape", leaves["shape"], shapes),
    ]
    if point.motion.poses is not None:
        return found
    ratio = leaves["box_ratio"] or mean_size(point, files) ** 2 / derived_parameters(point, files)["box_side"] ** 2
    found.append(Input("box_ratio", "box ratio (size / side)²", f"{ratio:.4g}"))
    if point.scene.bodies is None:  # bodies that are given one by one have their number and speeds
        found.insert(3, Input("count", "number of bodies", str(leaves["count"]), inputmode="numeric"))
        found.append(Input("speed", "speed, m/s", json.dumps(leaves["speed"]).replace('"', ""), inputmode="text"))
    return found


def _answer(
    experiment: Experiment, meshes: Opened, servers: Servers, first: Mapping[str, str], asked: Mapping[str, str]
) -> dict[str, Any]:
    """Run the first point with the changed inputs: once measured, once recorded."""
    changed = {name: text for name, text in asked.items() if name in first and text.strip() != first[name]}
    try:
        now = load_text(_first_point_alone(experiment), experiment.path, changed, known_names())
    except InputError as error:
        return {"error": " ".join(_sentence(problem.message) for problem in error.problems)}
    point = now.points[0]
    report = servers.run(*task_of(now, point, meshes))
    if report.status != "ok":
        return {"error": _sentence(f"the run did not come to its end ({report.status}): {report.reason}")}
    answer: dict[str, Any] = {"said": _summary(report), "row": _row(point, files_of(now, point, meshes), report)}
    bodies = point.scene.count if point.scene.bodies is None else len(point.scene.bodies)
    if (bodies or 0) > MOST_BODIES or report.metrics["events"] > MOST_HITS:
        answer["said"] += f" Too much to show: at most {MOST_BODIES} bodies and {MOST_HITS} hits are."
        return answer
    shown = servers.run(*task_of(now, point, meshes, recorded=True))
    if shown.recording is None:
        answer["said"] += f" It cannot be shown: {shown.reason}."
    else:
        answer["recording"] = document(shown.recording, now.title)
    return answer


def _first_point_alone(experiment: Experiment) -> str:
    """The text of an experiment whose one point is the first of this one."""
    file: dict[str, Any] = {"title": experiment.title, "scene": {}, "motion": {}, "engine": {}}
    for name, value in experiment.points[0].parameters.items():
        if value != plain(LEAVES[name].default):
            file[LEAVES[name].section][name] = value
    limits = experiment.measure
    file["measure"] = {"repeats": 1, "timeout": limits.timeout, "memory": limits.memory}
    return str(yaml.safe_dump(file))


def _sentence(message: str) -> str:
    said = message.removeprefix("--set ")  # inputs are passed on as overrides, which the user of the page has not typed
    text = said if said != message else said[0].upper() + said[1:]
    return text if text.endswith(".") else f"{text}."


def _summary(report: Report) -> str:
    found = report.metrics
    hits = f"{found['pair_hits']:.0f} hits between bodies and {found['box_hits']:.0f} at walls"
    sentences = [f"{hits}, found in {_milliseconds(report)} ms of CPU time."]
    warnings = report.plan.warnings if report.plan else ()
    return " ".join([*sentences, *(_sentence(warning) for warning in warnings)])


def _row(point: Point, files: SceneFiles, report: Report) -> list[str]:
    leaves, found = {**point.parameters, **derived_parameters(point, files)}, report.metrics
    count = leaves["count"] if leaves["bodies"] is None else len(leaves["bodies"])
    ratio = leaves["box_ratio"] or mean_size(point, files) ** 2 / leaves["box_side"] ** 2
    return [
        leaves["algorithm"],
        leaves["backend"],
        leaves["shape"],
        str(count),
        f"{ratio:.4g}",
        json.dumps(leaves["speed"]).replace('"', ""),
        *(f"{found[name]:.0f}" if name in found else "–" for name in ("pair_hits", "box_hits", "pair_tests")),
        _milliseconds(report),
        f"{found['simulated_per_second']:.4g}" if "simulated_per_second" in found else "–",
    ]


def _milliseconds(report: Report) -> str:
    return f"{1000 * report.metrics['run_seconds']:.3g}"
