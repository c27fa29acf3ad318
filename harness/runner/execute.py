"""One run in this process: build the scene, plan it, fly it, and say what came out."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import Any

from harness.backends import registry
from harness.backends.protocol import assemble
from harness.backends.statement import approximation
from harness.errors import InputError
from harness.experiment.experiment import Point
from harness.measure.clocks import Clock
from harness.motion.hits import Outcome, Trace
from harness.motion.invariance import invariance
from harness.motion.plan import Plan, make_plan
from harness.motion.predicted import fly_predicted
from harness.motion.soundness import NotANumberError
from harness.motion.stepped import fly_stepped
from harness.runner import accuracy
from harness.runner.recording import recording_of
from harness.runner.repetition import fly_long_enough
from harness.runner.setting import build_scene
from harness.runner.warm_up import warm_up
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.store.recording import Recording


@dataclass(frozen=True)
class Result:
    """What a run that came to its end has measured, and in how many flights of its scene."""

    metrics: dict[str, float]
    plan: Plan
    trace: Trace | None = None
    flights: int = 1
    recording: Recording | None = None


def execute(
    point: Point,
    mesh: Mesh | None,
    *,
    memory: int | None = None,
    traced: bool = False,
    recorded: bool = False,
    asked: Collection[str] = (),
) -> Result:
    """Run a point once, in this process.

    Parameters
    ----------
    point : Point
    mesh : the mesh its scene names
    memory : B that the scene may need
    traced : keep every hit
    recorded : keep what a replay shows, and measure nothing else: the clocks of such a run see it
    asked : metrics that are made on demand alone, and are demanded

    Raises
    ------
    PlacementError, SceneSizeError, InputError
        If the point cannot be run as it is declared.
    NotANumberError
        If what it came to is not all numbers.
    """
    warm_up(point)
    clock = Clock("setup_seconds")
    scene = build_scene(point, mesh, memory)
    plan = plan_of(point, scene)
    # what a stepped run watches is outside of its clocks; a predictive one would keep its events within them
    watched = traced or recorded or (point.reference is not None and point.engine.algorithm != "predictive")
    fly = _flight(point, scene, plan, traced=watched, recorded=recorded)
    clock.lap("setup_seconds")
    outcome, flights = (fly(), 1) if traced or recorded else fly_long_enough(fly)
    metrics = outcome.metrics | clock.metrics() | {"peak_memory": _peak_memory()}
    if recorded:
        return Result(metrics, plan, outcome.trace, flights, recording_of(point, scene, outcome))
    metrics |= invariance(asked, scene, partial(_hits, point, plan=plan))
    if point.reference is not None and not traced:
        metrics |= accuracy.errors(point, mesh, outcome.trace or _hits(point, scene), _hits)
    _refuse_what_is_no_number(metrics)
    return Result(metrics, plan, outcome.trace if traced else None, flights)


def _flight(
    point: Point, scene: Scene, plan: Plan, *, traced: bool, recorded: bool = False, slower: float = 1.0
) -> Callable[[], Outcome]:
    """One flight of the scene, from its start, whenever it is called; what it needs is loaded.

    `slower` is by how much its duration and its frames are longer than the point says.
    """
    motion = point.motion
    answers: dict[str, Any] = {"response": motion.response, "restitution": motion.restitution}
    answers |= {"traced": traced, "recorded": recorded}
    if point.engine.algorithm == "predictive":
        tolerance = point.engine.tolerance
        return partial(fly_predicted, scene, plan, duration=motion.duration * slower, tolerance=tolerance, **answers)
    backend = registry.create(point.engine.backend, point.engine.algorithm) if plan.keeps("pairs") else None
    if backend is not None:
        if scene.shape not in backend.shapes:
            raise InputError(f'backend "{backend.name}" has no shape {scene.shape}, only {", ".join(backend.shapes)}')
        assemble(backend, point.engine.stages)
        backend.load(scene)
    return partial(fly_stepped, scene, plan, backend, frames=motion.frames, dt=motion.dt * slower, **answers)


def _hits(point: Point, scene: Scene, slower: float = 1.0, plan: Plan | None = None) -> Trace:
    """Every hit of a flight of its own, by the method of the point; by default with the scene's own plan."""
    trace = _flight(point, scene, plan or plan_of(point, scene), traced=True, slower=slower)().trace
    assert trace is not None, "a traced flight has a trace"
    return trace


def _refuse_what_is_no_number(metrics: Mapping[str, float]) -> None:
    wrong = [f"{name} is {value}" for name, value in metrics.items() if not isfinite(value)]
    if wrong:
        raise NotANumberError(", ".join(wrong))


def plan_of(point: Point, scene: Scene) -> Plan:
    """The plan of a point, whose scene is at hand.

    Raises
    ------
    InputError
        If the point forces a stage that cannot be forced, or its backend is missing.
    """
    approximated = None
    if len(scene.bodies) > 1 and point.engine.algorithm == "native":
        approximated = approximation(point.engine.backend, scene.shape)
    return make_plan(
        scene,
        backend=point.engine.backend,
        algorithm=point.engine.algorithm,
        response=point.motion.response,
        duration=_flown(point),
        approximated=approximated,
        forced=point.engine.stages,
    )


def _flown(point: Point) -> float:
    """s of simulated time until the last frame, or the end of an event-driven run."""
    motion = point.motion
    return motion.duration if point.engine.algorithm == "predictive" else motion.frames * motion.dt


def _peak_memory() -> float:
    """B, largest resident memory of this process so far."""
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
