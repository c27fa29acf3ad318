"""One run in this process: build the scene, plan it, fly it, and say what came out."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.backends.protocol import approximations
from harness.broadphase.grid import Grid
from harness.experiment.experiment import Point
from harness.measure.clocks import Clock
from harness.motion.hits import Outcome, Trace
from harness.motion.plan import Plan, make_plan
from harness.motion.predicted import fly_predicted
from harness.motion.predictive import simulation
from harness.motion.response import Response
from harness.motion.stepped import fly_stepped
from harness.narrowphase.containment import Containment
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.hull_pairs import HullPairs
from harness.narrowphase.mesh_pairs import MeshPairs
from harness.narrowphase.placement import Places
from harness.runner import accuracy
from harness.runner.repetition import fly_long_enough
from harness.runner.setting import build_scene
from harness.runner.trial import trial_scene
from harness.scene.launch import place
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene, Shape


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
    warm_up()
    clock = Clock("setup_seconds")
    scene = build_scene(point, mesh, memory)
    plan = plan_of(point, scene)
    # what a stepped run watches is outside of its clocks; a predictive one would keep its events within them
    watched = traced or (point.reference is not None and point.engine.algorithm != "predictive")
    fly = _flight(point, scene, plan, watched)
    clock.lap("setup_seconds")
    outcome, flights = (fly(), 1) if traced else fly_long_enough(fly)
    metrics = outcome.metrics | clock.metrics() | {"peak_memory": _peak_memory()}
    if point.reference is not None and not traced:
        metrics |= accuracy.errors(point, mesh, outcome.trace or _hits(point, scene), _hits)
    return Result(metrics, plan, outcome.trace if traced else None, flights)


def _hits(point: Point, scene: Scene) -> Trace:
    """Every hit of a flight of its own."""
    trace = _flight(point, scene, plan_of(point, scene), traced=True)().trace
    assert trace is not None
    return trace


def _flight(point: Point, scene: Scene, plan: Plan, traced: bool) -> Callable[[], Outcome]:
    """One flight of the scene, from its start, whenever it is called; what it needs is loaded."""
    motion = point.motion
    answers: dict[str, Any] = {"response": motion.response, "restitution": motion.restitution, "traced": traced}
    if point.engine.algorithm == "predictive":
        tolerance = point.engine.tolerance
        return partial(fly_predicted, scene, plan, duration=motion.duration, tolerance=tolerance, **answers)
    backend = registry.create(point.engine.backend, point.engine.algorithm) if plan.keeps("pairs") else None
    if backend is not None:
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
        approximated=approximated,
        forced=point.engine.stages,
    )


@cache
def warm_up() -> None:
    """Compile every kernel, or load it from numba's cache, so that no clock of a run sees it."""
    trial = trial_scene("mesh")
    mesh, bodies, box = trial.mesh, trial.bodies, trial.box
    assert mesh is not None
    shapes: tuple[Shape, ...] = ("sphere", "hull")
    responses: tuple[Response, ...] = ("reflect", "elastic", "none")
    simulation.warm_up()
    place(bodies.radii, box, np.random.default_rng(0), overlap=False)
    grid = Grid(bodies.radii, box)
    close = grid.close_pairs(bodies.positions)
    grid.cells_per_body()
    placement = Places(bodies.sizes).at(bodies.positions, bodies.quaternions)
    HullPairs(mesh.hull, MARGIN).settle(close, placement)
    MeshPairs(mesh).settle(close, placement)
    Containment(mesh).contained(np.array([[0, 1]]), placement)
    for shape in shapes:
        scene = Scene(shape, mesh, bodies, box)
        for response in responses:
            plan = make_plan(scene, backend="", algorithm="native", response=response)
            fly_stepped(scene, plan, _Meeting(), frames=2, dt=0.3, response=response)
    scene = Scene("hull", mesh, bodies, box)
    fly_predicted(
        scene,
        make_plan(scene, backend="fcl", algorithm="predictive", response="reflect"),
        duration=0.3,
        response="reflect",
    )


class _Meeting:
    """A detector for `warm_up`: the two bodies always touch."""

    name = "meeting"
    shapes: tuple[Shape, ...] = ("sphere", "hull")

    def tolerance(self, shape: Shape) -> float:
        return 0.0

    def load(self, scene: Scene) -> None:
        pass

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return np.array([[0, 1]])


def _peak_memory() -> float:
    """B, largest resident memory of this process so far."""
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
