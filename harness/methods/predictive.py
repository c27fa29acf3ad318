"""Predictive scheduling: from event to event, without frames.

The event loop is `harness.motion.predictive`; here are its plan, and a run of it, with its clock, counters and what it
conserves.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from harness.arrays import Floats
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.ignored import asked_about
from harness.measure.clocks import Clock
from harness.measure.conservation import Conservation, energy
from harness.measure.kinetics import Kinetics
from harness.methods.culled import equal_sizes
from harness.methods.ill_posed import ill_posed
from harness.methods.method import Method, Pipeline, WarmUp
from harness.methods.penetration import Penetration
from harness.methods.stages import Decisions, Plan
from harness.methods.stepped import but_for_the_ignored, decide_penetration, decide_recording
from harness.methods.warm_up_scene import RESPONSES, TOUCHING, of_meshes, two_bodies
from harness.motion.course import Course, CourseLog
from harness.motion.finite import require_finite_state
from harness.motion.hit_states import states_of_events
from harness.motion.hits import Outcome, Trace
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.motion.predictive.codes import Event
from harness.motion.predictive.initial import check
from harness.motion.predictive.rules import LASTING, choose_search
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.solid_simulation import SolidSimulation
from harness.motion.predictive.solids import Form, needs_its_surface
from harness.scene.scene import Scene
from harness.vocabulary import Shape

# How often the state of a run is measured outside of its clock; events are the same to the bit however often.
SAMPLES = 5

_FIXED = "event-driven motion cannot do otherwise"


class Predictive(Method):
    """Computes the next hit of every body, and flies from hit to hit."""

    def plan(self, scene: Scene, law: MotionLaw, *, recorded: bool = False) -> Plan:
        decisions, solid = Decisions(self.forced), scene.shape != "sphere"

        def take(name: str, kept: bool, why: str) -> None:
            decisions.take(name, kept, why, fixed=_FIXED)

        take("frames", False, "events are computed, not stepped to")
        if solid:
            take("orientations", True, "bodies are turned where a contact is searched, and nowhere else")
            take("backend", False, "contacts are searched by conservative advancement; no library is asked")
        else:
            take("orientations", False, "a sphere looks the same however it is turned")
            take("backend", False, "spheres are solved in closed form; no library is asked")
        _decide_pairs(scene, law, decisions)
        take("walls", True, "the next wall of each body, from its velocity")
        if solid and law.response == "none":
            take("wall_search", False, "response is none: the box folds the path of each bounding sphere exactly")
        elif solid:
            take("wall_search", True, "the support function of the hull, once a bounding sphere meets the wall")
        if solid:
            _decide_contact_end(law, decisions)
        _decide_lasting_contacts(law, decisions)
        decide_penetration(scene, decisions)
        decide_recording(recorded, decisions)
        return decisions.finish(ill_posed(scene, law))

    def load(self, scene: Scene, plan: Plan) -> Pipeline:
        return EventDriven(scene, plan, self.tolerance)

    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        shape: Shape = self.name.shape
        yield f"events of {shape}s{of_meshes(meshes)}", partial(_fly_events, shape, meshes)


def _decide_pairs(scene: Scene, law: MotionLaw, decisions: Decisions) -> None:
    """How the next hit of a pair is found: among which neighbours, and by which searches."""
    count, solid = len(scene.bodies), scene.shape != "sphere"
    alone = f"there is no pair of bodies among {count}"
    grids = "cells of one size" if equal_sizes(scene) else "a hierarchy of cells, one level a size class"
    if solid:
        found = f"from when to when each body's bounding sphere overlaps its neighbours', found by {grids}"
    else:
        found = f"the next hit of each body among its neighbours, from {grids} or from lists when dense"

    def take(name: str, kept: bool, why: str) -> None:
        decisions.take(name, kept and count > 1, why if count > 1 else alone, fixed=_FIXED)

    take("pairs", True, f"{found}{but_for_the_ignored(scene)}")
    if not solid:
        _decide_neighbour_lists(scene, law, decisions)
        return
    take("hull_search", True, "hulls are advanced to their contact when their spheres meet, not before")
    if scene.shape == "hull":
        decisions.take("mesh_search", False, "the shape is the hull", fixed="the shape is the hull")
    elif needs_its_surface(scene):
        take("mesh_search", True, "surfaces are advanced to their contact when their hulls meet, not before")
    else:
        take("mesh_search", False, "every mesh is convex, its own hull, and no body can be inside an equal one")


def _decide_contact_end(law: MotionLaw, decisions: Decisions) -> None:
    """Whether a contact lasts, and is followed."""
    if law.response == "none":
        why = "a pair that touches is followed until it parts, for only then can it begin to touch again"
        decisions.take("contact_end", True, why, fixed="hits would be missed")
    else:
        why = "a touch is answered, and over at once"
        decisions.take("contact_end", False, why, fixed=why)


def _decide_lasting_contacts(law: MotionLaw, decisions: Decisions) -> None:
    """Whether an inelastic collapse, infinitely many hits in a finite time, must be kept from happening."""
    loses = law.response == "elastic" and law.restitution < 1.0
    if loses:
        why = (
            f"restitution {law.restitution:g}: after {LASTING} hits in a row, each within the contact time of the "
            "last, a body's hits lose no more energy (TC model)"
        )
        fixed = "the flight might never get past an inelastic collapse"
    else:
        why = "hits lose no energy: nothing can collapse"
        fixed = why
    decisions.take("lasting_contacts", loses, why, fixed=fixed)


def _decide_neighbour_lists(scene: Scene, law: MotionLaw, decisions: Decisions) -> None:
    """Whether neighbours are listed, and the lists renewed now and then, or looked for in cells at every search."""
    bodies = scene.bodies
    start = check(bodies.positions, bodies.velocities, bodies.radii, bodies.masses, scene.box.half)
    listed = choose_search(start, law.response) == "lists"
    if listed:
        why = f"at packing {scene.packing:.3g} bodies stay among their neighbours: these are listed"
    else:
        why = "neighbours come from cells: lists pay at high packing, for bodies of one size that answer their hits"
    decisions.take("neighbour_lists", listed, why, fixed="times of hits would differ in their last digits")


class EventDriven:
    """The plan of an event-driven run, assembled.

    Parameters
    ----------
    scene : Scene
    plan : Plan of this scene
    tolerance : of size; surfaces nearer than that touch. Spheres need none
    """

    def __init__(self, scene: Scene, plan: Plan, tolerance: float) -> None:
        self._scene, self._plan, self._tolerance = scene, plan, tolerance
        self._form = None
        if plan.keeps("orientations"):
            self._form = Form(scene, surface=plan.keeps("mesh_search"), followed=plan.keeps("contact_end"))

    def fly(self, law: MotionLaw, *, traced: bool = False, observed: bool = True) -> Outcome:
        """Fly the scene for `law.duration`, event by event; what is due at that very time still happens.

        Parameters
        ----------
        law : MotionLaw
        traced : keep every event
        observed : without, the run's clock alone

        Returns
        -------
        Outcome
            With the counters, the run's clock and the errors of a predictive run.
        """
        scene, plan = self._scene, self._plan
        recorded = plan.keeps("recording")
        samples = _Samples(scene, plan, law) if observed else None
        clock = Clock("run_seconds")
        simulation = self._start(law, record=traced or recorded, states=recorded)
        clock.lap("run_seconds")
        for sample in range(1, SAMPLES + 1):
            clock.start()
            until = law.duration * sample / SAMPLES
            simulation.advance(until)
            clock.lap("run_seconds")
            if samples is not None:
                samples.take(simulation, until)
        clocks = clock.metrics()
        for kind in ("", "_elapsed"):
            if clocks[f"run_seconds{kind}"] > 0.0:
                clocks[f"simulated_per_second{kind}"] = law.duration / clocks[f"run_seconds{kind}"]
        if samples is None:
            return Outcome(clocks, None)
        counted = simulation.counters
        metrics: dict[str, float] = {**counted, **clocks, **samples.metrics(simulation)}
        if counted["events"]:
            metrics["predictions_per_event"] = counted["predictions"] / counted["events"]
            metrics["pair_tests_per_event"] = counted["pair_tests"] / counted["events"]
        trace = _trace(scene, plan, simulation, law.duration, counted) if traced or recorded else None
        return Outcome(metrics, trace if traced else None, None if trace is None else _course(scene, trace))

    def _start(self, law: MotionLaw, *, record: bool, states: bool) -> Simulation:
        """The simulation at time 0; its clock runs already."""
        bodies, box = self._scene.bodies, self._scene.box
        if self._form is not None:
            return SolidSimulation(
                bodies,
                box,
                self._form,
                law.response,
                law.restitution,
                record=record,
                states=states,
                tolerance=self._tolerance,
                ignored=self._scene.ignored,
            )
        return Simulation(
            bodies.positions,
            bodies.velocities,
            bodies.radii,
            bodies.masses,
            box.half,
            response=law.response,
            restitution=law.restitution,
            record=record,
            states=states,
            search="lists" if self._plan.keeps("neighbour_lists") else "cells",
            ignored=self._scene.ignored,
        )


class _Samples:
    """Measures a run at a few times, outside of its clock: what it conserves, escaped bodies, the depth of overlaps."""

    def __init__(self, scene: Scene, plan: Plan, law: MotionLaw) -> None:
        self._elastic, self._half = law.response == "elastic", scene.box.half
        self._conservation = Conservation(scene.bodies)
        self._kinetics = Kinetics(scene, law.response, law.restitution)
        self._depth = _Depth(scene) if plan.keeps("penetration") else None
        self._outside = np.zeros(len(scene.bodies), np.bool_)
        self._begun = False

    def take(self, simulation: Simulation, time: float) -> None:
        """Measure the state at a time, s."""
        positions, velocities = simulation.positions, simulation.velocities
        require_finite_state(positions, velocities, simulation.time)
        self._conservation.observe(velocities)
        if self._elastic:
            self._conservation.observe_momentum(velocities, simulation.wall_impulses)
        self._outside |= (np.abs(positions) > self._half).any(axis=1)
        if self._depth is not None:
            self._depth.measure(positions, time)
        if not self._begun:  # from the first sample on, the start is forgotten
            self._kinetics.begin(simulation)
            self._begun = True

    def metrics(self, simulation: Simulation) -> dict[str, float]:
        """The errors and the kinetics measured."""
        found = {
            "energy_drift": self._conservation.energy_drift,
            "escaped": float(np.count_nonzero(self._outside)),
            **self._kinetics.end(simulation),
        }
        if self._elastic:
            found["momentum_drift"] = self._conservation.momentum_drift
        if self._depth is not None:
            found["max_penetration"] = self._depth.deepest
        return found


class _Depth:
    """The deepest overlap of those times."""

    def __init__(self, scene: Scene) -> None:
        self.deepest = 0.0
        self._trajectory = Trajectory(scene.bodies, scene.box, folded=False, turning=scene.shape != "sphere")
        self._broad_phase = asked_about(HierarchicalGrid(scene.bodies.radii, scene.box), scene.ignored)
        self._penetration = Penetration(scene)

    def measure(self, positions: Floats, time: float) -> None:
        pairs = self._broad_phase.close_pairs(positions)
        self._trajectory.move_to(time)
        self.deepest = self._penetration.deepest(pairs, positions, self._trajectory.quaternions, self.deepest)


def _trace(scene: Scene, plan: Plan, simulation: Simulation, duration: float, counted: dict[str, int]) -> Trace:
    """All hits; where the plan keeps a recording, with the states of their bodies."""
    masses = scene.bodies.masses
    states: Any = simulation.take_states() if plan.keeps("recording") else None
    events: Any = simulation.take_events()
    pair = events["kind"] == Event.PAIR
    bodies = np.column_stack([events["i"], np.where(pair, events["j"], -1)]).astype(np.int64)
    velocities = simulation.velocities
    return Trace(
        times=events["time"],
        bodies=bodies,
        walls=np.where(pair, -1, events["wall"]).astype(np.int64),
        time=duration,
        positions=simulation.positions,
        velocities=velocities,
        energy=energy(velocities, masses),
        counters=counted,
        states=None if states is None else states_of_events(states, bodies, masses),
    )


def _course(scene: Scene, trace: Trace) -> Course | None:
    """The course of every body, where the states of its hits were kept."""
    if trace.states is None:
        return None
    log = CourseLog(scene.bodies.positions, scene.bodies.velocities)
    log.add_hits(trace.times, trace.bodies, trace.states)
    return log.course()


def _fly_events(shape: Shape, meshes: int) -> None:
    """A flight from event to event with every response, from cells and from lists."""
    scene, duration = two_bodies(shape, meshes), 0.3
    stages = Decisions()
    for name in ("pairs", "orientations", "hull_search"):
        stages.take(name, name == "pairs" or shape != "sphere", "")
    stages.take("mesh_search", shape == "mesh" and needs_its_surface(scene), "")
    decide_penetration(scene, stages)
    pipeline = EventDriven(scene, stages.finish(), tolerance=1e-6)
    for response in RESPONSES:
        pipeline.fly(MotionLaw(duration, duration, response))
    if shape != "mesh":
        Penetration(scene).deepest(TOUCHING, scene.bodies.positions, scene.bodies.quaternions)


METHOD = Predictive
