"""Predictive motion: from event to event, without frames.

The event loop is `harness.motion.predictive`; this is a run of it, with its clock, counters and what it conserves.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.arrays import Floats
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.measure.clocks import Clock
from harness.measure.conservation import Conservation, energy
from harness.measure.kinetics import Kinetics
from harness.motion.course import CourseLog
from harness.motion.hits import Outcome, Trace
from harness.motion.kinematics import Flight
from harness.motion.plan import Plan
from harness.motion.predictive.simulation import PAIR_EVENT, Simulation
from harness.motion.predictive.solid_simulation import SolidSimulation
from harness.motion.predictive.solids import Form
from harness.motion.soundness import refuse_lost
from harness.narrowphase.penetration import Penetration
from harness.scene.scene import Scene
from harness.vocabulary import Response

# How often a run is looked at from outside its clock; events are the same to the bit however often.
LOOKS = 5


def fly_predicted(
    scene: Scene,
    plan: Plan,
    *,
    duration: float,
    response: Response,
    restitution: float = 1.0,
    tolerance: float = 1e-6,
    traced: bool = False,
    recorded: bool = False,
) -> Outcome:
    """Fly a scene for `duration` (s), event by event.

    Parameters
    ----------
    scene : Scene
    plan : Plan of this scene
    duration : s; what is due at that very time still happens
    response, restitution : see `harness.motion.response`
    tolerance : of size; surfaces nearer than that touch. Spheres need none
    traced : keep every event
    recorded : keep the course of every body; the clock of such a flight sees it

    Returns
    -------
    Outcome
        With the counters, the run's clock and the errors of a predictive run.
    """
    bodies = scene.bodies
    conservation, kinetics = Conservation(bodies), Kinetics(scene, response, restitution)
    depth = _Depth(scene) if plan.keeps("penetration") else None
    form = None if scene.shape == "sphere" else Form(scene)
    course = CourseLog(bodies.positions, bodies.velocities) if recorded else None
    clock = Clock("run_seconds")
    if form is None:
        simulation = Simulation(
            bodies.positions,
            bodies.velocities,
            bodies.radii,
            bodies.masses,
            scene.box.half,
            response=response,
            restitution=restitution,
            record=traced,
        )
    else:
        simulation = SolidSimulation(bodies, scene.box, form, response, restitution, record=traced, tolerance=tolerance)
    clock.lap("run_seconds")
    outside = np.zeros(len(bodies), np.bool_)
    for look in range(1, LOOKS + 1):
        clock.start()
        until = duration * look / LOOKS
        if course is not None:
            course.follow(simulation, until)
        else:
            simulation.advance(until)
        clock.lap("run_seconds")
        positions, velocities = simulation.positions, simulation.velocities
        refuse_lost(positions, velocities, simulation.time)
        conservation.observe(velocities)
        if response == "elastic":
            conservation.observe_momentum(velocities, simulation.wall_impulses)
        outside |= (np.abs(positions) > scene.box.half).any(axis=1)
        if depth is not None:
            depth.look(positions, duration * look / LOOKS)
        if look == 1:
            kinetics.begin(simulation)

    counted = simulation.counters
    metrics: dict[str, float] = {
        **counted,
        **clock.metrics(),
        "energy_drift": conservation.energy_drift,
        "escaped": float(np.count_nonzero(outside)),
        **kinetics.end(simulation),
    }
    for kind in ("", "_elapsed"):
        if metrics[f"run_seconds{kind}"] > 0.0:
            metrics[f"simulated_per_second{kind}"] = duration / metrics[f"run_seconds{kind}"]
    if counted["events"]:
        metrics["predictions_per_event"] = counted["predictions"] / counted["events"]
        metrics["pair_tests_per_event"] = counted["pair_tests"] / counted["events"]
    if response == "elastic":
        metrics["momentum_drift"] = conservation.momentum_drift
    if depth is not None:
        metrics["max_penetration"] = depth.deepest
    trace = _trace(scene, simulation, duration, counted) if traced else None
    return Outcome(metrics, trace, course.course() if course is not None else None)


class _Depth:
    """The deepest overlap found by looking now and then."""

    def __init__(self, scene: Scene) -> None:
        self.deepest = 0.0
        self._flight = Flight(scene.bodies, scene.box, folded=False, turning=scene.shape != "sphere")
        self._grid = HierarchicalGrid(scene.bodies.radii, scene.box)
        self._penetration = Penetration(scene)

    def look(self, positions: Floats, time: float) -> None:
        pairs = self._grid.close_pairs(positions)
        self._flight.move_to(time)
        self.deepest = max(self.deepest, self._penetration.deepest(pairs, positions, self._flight.quaternions))


def _trace(scene: Scene, simulation: Simulation, duration: float, counted: dict[str, int]) -> Trace:
    events: Any = simulation.take_events()
    pair = events["kind"] == PAIR_EVENT
    velocities = simulation.velocities
    return Trace(
        times=events["time"],
        bodies=np.column_stack([events["i"], np.where(pair, events["j"], -1)]).astype(np.int64),
        walls=np.where(pair, -1, events["wall"]).astype(np.int64),
        time=duration,
        positions=simulation.positions,
        velocities=velocities,
        energy=energy(velocities, scene.bodies.masses),
        counters=counted,
    )
