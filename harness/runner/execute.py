"""One run in this process: build the scene, plan it, fly it, and say what came out."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from harness.backends import registry
from harness.backends.protocol import approximations, assemble
from harness.experiment.experiment import Point
from harness.measure.clocks import Clock
from harness.motion.hits import Outcome, Trace
from harness.motion.plan import Plan, make_plan
from harness.motion.predicted import fly_predicted
from harness.motion.stepped import fly_stepped
from harness.runner.repetition import fly_long_enough
from harness.runner.setting import build_scene
from harness.runner.warm_up import warm_up
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene


@dataclass(frozen=True)
class Result:
    """What a run that came to its end has measured, and in how many flights of its scene."""

    metrics: dict[str, float]
    plan: Plan
    trace: Trace | None = None
    flights: int = 1


def execute(point: Point, mesh: Mesh | None, *, memory: int | None = None, traced: bool = False) -> Result:
    """Run a point once, in this process.

    Parameters
    ----------
    point : Point
    mesh : the mesh its scene names
    memory : B that the scene may need
    traced : keep every hit

    Raises
    ------
    PlacementError, SceneSizeError, InputError
        If the point cannot be run as it is declared.
    """
    warm_up(point)
    clock = Clock("setup_seconds")
    scene = build_scene(point, mesh, memory)
    plan = plan_of(point, scene)
    fly = _flight(point, scene, plan, traced)
    clock.lap("setup_seconds")
    outcome, flights = (fly(), 1) if traced else fly_long_enough(fly)
    metrics = outcome.metrics | clock.metrics() | {"peak_memory": _peak_memory()}
    return Result(metrics, plan, outcome.trace, flights)


def _flight(point: Point, scene: Scene, plan: Plan, traced: bool) -> Callable[[], Outcome]:
    """One flight of the scene, from its start, whenever it is called; what it needs is loaded."""
    motion = point.motion
    answers: dict[str, Any] = {"response": motion.response, "restitution": motion.restitution, "traced": traced}
    if point.engine.algorithm == "predictive":
        tolerance = point.engine.tolerance
        return partial(fly_predicted, scene, plan, duration=motion.duration, tolerance=tolerance, **answers)
    backend = registry.create(point.engine.backend, point.engine.algorithm) if plan.keeps("pairs") else None
    if backend is not None:
        assemble(backend, point.engine.stages)
        backend.load(scene)
    return partial(fly_stepped, scene, plan, backend, frames=motion.frames, dt=motion.dt, **answers)


def plan_of(point: Point, scene: Scene) -> Plan:
    """The plan of a point, whose scene is at hand.

    Raises
    ------
    InputError
        If the point forces a stage that cannot be forced, or its backend is missing.
    """
    approximated = None
    if len(scene.bodies) > 1 and point.engine.algorithm == "native":
        approximated = approximations(registry.create(point.engine.backend)).get(scene.shape)
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
