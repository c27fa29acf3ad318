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
from harness.runner.recording import recording_of
from harness.runner.repetition import fly_long_enough
from harness.runner.setting import build_scene
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import convex_hull
from harness.scene.launch import place
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene, Shape
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
    point: Point, mesh: Mesh | None, *, memory: int | None = None, traced: bool = False, recorded: bool = False
) -> Result:
    """Run a point once, in this process.

    Parameters
    ----------
    point : Point
    mesh : the mesh its scene names
    memory : B that the scene may need
    traced : keep every hit
    recorded : keep what a replay shows; the clocks of such a run see it

    Raises
    ------
    PlacementError, SceneSizeError, InputError
        If the point cannot be run as it is declared.
    """
    warm_up()
    clock = Clock("setup_seconds")
    scene = build_scene(point, mesh, memory)
    plan = plan_of(point, scene)
    fly = _flight(point, scene, plan, traced=traced or recorded, recorded=recorded)
    clock.lap("setup_seconds")
    outcome, flights = (fly(), 1) if traced or recorded else fly_long_enough(fly)
    metrics = outcome.metrics | clock.metrics() | {"peak_memory": _peak_memory()}
    return Result(metrics, plan, outcome.trace, flights, recording_of(point, scene, outcome) if recorded else None)


def _flight(point: Point, scene: Scene, plan: Plan, *, traced: bool, recorded: bool) -> Callable[[], Outcome]:
    """One flight of the scene, from its start, whenever it is called; what it needs is loaded."""
    motion = point.motion
    answers: dict[str, Any] = {"response": motion.response, "restitution": motion.restitution}
    answers |= {"traced": traced, "recorded": recorded}
    if point.engine.algorithm == "predictive":
        return partial(fly_predicted, scene, plan, duration=motion.duration, **answers)
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
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(12)
    hull = convex_hull(corners)
    mesh = Mesh("tetrahedron", hull.vertices, hull.faces, hull, "", watertight=True, convex=True)
    bodies = Bodies(
        positions=np.array([[-0.6, 0, 0], [0.6, 0, 0]]),
        velocities=np.array([[1.0, 1, 1], [-1, -1, -1]]),
        quaternions=np.tile([1.0, 0, 0, 0], (2, 1)),
        spins=np.ones((2, 3)),
        sizes=np.ones(2),
        masses=np.ones(2),
    )
    shapes: tuple[Shape, ...] = ("sphere", "hull")
    responses: tuple[Response, ...] = ("reflect", "elastic", "none")
    box = Box(np.full(3, 1.2))
    simulation.warm_up()
    place(bodies.radii, box, np.random.default_rng(0), overlap=False)
    grid = Grid(bodies.radii, box)
    close = grid.close_pairs(bodies.positions)
    grid.cells_per_body()
    placement = Places(bodies.sizes).at(bodies.positions, bodies.quaternions)
    HullPairs(hull, MARGIN).settle(close, placement)
    MeshPairs(mesh).settle(close, placement)
    Containment(mesh).contained(np.array([[0, 1]]), placement)
    for shape in shapes:
        scene = Scene(shape, mesh, bodies, box)
        for response in responses:
            plan = make_plan(scene, backend="", algorithm="native", response=response)
            fly_stepped(scene, plan, _Meeting(), frames=2, dt=0.3, response=response)


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
