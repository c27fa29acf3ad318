"""Stepped motion: frame after frame, advance, find all touching pairs, answer them, then the walls.

Walls come last, so that no answer to a pair can send a centre out of the box.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from harness.arrays import Flags
from harness.backends.protocol import Backend, counters
from harness.measure.clocks import Clock
from harness.measure.conservation import energy
from harness.motion.hits import Outcome, Trace
from harness.motion.kinematics import Flight
from harness.motion.observer import Folds, Observer, Onsets
from harness.motion.plan import Plan
from harness.motion.response import Answers, Response
from harness.motion.soundness import refuse_lost
from harness.narrowphase.support import support_map
from harness.narrowphase.walls import hulls_at_walls, spheres_at_walls
from harness.scene.scene import Scene


def fly_stepped(
    scene: Scene,
    plan: Plan,
    backend: Backend | None,
    *,
    frames: int,
    dt: float,
    response: Response,
    restitution: float = 1.0,
    traced: bool = False,
) -> Outcome:
    """Fly a scene in frames at k dt, k = 1 … frames.

    Parameters
    ----------
    scene : Scene
    plan : Plan of this scene
    backend : loaded with the scene; None where the plan leaves pairs out
    frames, dt : number and length (s) of the frames
    response, restitution : see `harness.motion.response`
    traced : keep every hit

    Returns
    -------
    Outcome
        With the counters, clocks and errors of a stepped run.
    """
    flight = Flight(scene.bodies, scene.box, folded=response == "none", turning=plan.keeps("orientations"))
    observer = Observer(scene, flight, penetration=plan.keeps("penetration"), traced=traced)
    answers = None if response == "none" else Answers(scene.bodies.masses, response, restitution)
    touching_walls = _wall_test(scene, plan)
    onsets, folds = Onsets(len(scene.bodies)), Folds(flight)
    pairs = np.empty((0, 2), np.int64)
    clock = Clock("pair_seconds", "response_seconds", "box_seconds")

    for frame in range(1, frames + 1):
        time = frame * dt
        clock.start()
        flight.move_to(time)
        if backend is not None:
            pairs = backend.pairs(flight.positions, flight.quaternions)
        clock.lap("pair_seconds")
        if answers is None:
            observer.frame(time, pairs, onsets.of(pairs), folds.by(time))
            continue
        answers.changed[:] = False
        hits = answers.pairs(pairs, flight.positions, flight.velocities)
        clock.lap("response_seconds")
        walls = answers.walls(touching_walls(flight), flight.velocities)
        flight.redirect(answers.changed, time)
        clock.lap("box_seconds")
        observer.frame(time, pairs, hits, walls)

    refuse_lost(flight.positions, flight.velocities, frames * dt)
    counted: dict[str, float] = {
        "frames": frames,
        **_pair_counters(backend),
        "box_tests": 6 * len(scene.bodies) * frames if plan.keeps("walls") else 0,
        "pair_hits": observer.pair_hits,
        "pair_contacts": observer.pair_contacts,
        "box_hits": observer.wall_hits,
        "events": observer.pair_hits + observer.wall_hits,
    }
    end = frames * dt
    metrics = {
        **counted,
        **_rates(counted, len(scene.bodies), frames, end),
        **_clock_metrics(clock, frames, end),
        **_errors(observer, answers, plan),
    }
    return Outcome(metrics, _trace(scene, flight, observer, end, counted) if traced else None)


def _wall_test(scene: Scene, plan: Plan) -> Callable[[Flight], Flags]:
    """The test of all bodies against the six walls that the scene needs; its answer is overwritten by the next."""
    touching = np.zeros((len(scene.bodies), 6), np.bool_)
    half, sizes, radii = scene.box.half, scene.bodies.sizes, scene.bodies.radii
    if scene.shape == "sphere" or scene.mesh is None:

        def spheres(flight: Flight) -> Flags:
            spheres_at_walls(flight.positions, radii, half, touching)
            return touching

        return spheres
    hull, cull = support_map(scene.mesh.hull.vertices), plan.keeps("wall_cull")

    def hulls(flight: Flight) -> Flags:
        hulls_at_walls(flight.positions, flight.quaternions, sizes, hull, half, cull, touching)
        return touching

    return hulls


def _pair_counters(backend: Backend | None) -> dict[str, float]:
    return {"pair_tests": 0, "narrow_tests": 0} if backend is None else dict(counters(backend))


def _rates(counted: Mapping[str, float], bodies: int, frames: int, simulated: float) -> dict[str, float]:
    rates = {}
    if "pair_tests" in counted and bodies and frames:
        rates["pair_tests_per_body"] = counted["pair_tests"] / (bodies * frames)
    if bodies and simulated > 0.0:
        rates["collision_rate"] = 2.0 * counted["pair_hits"] / (bodies * simulated)
    return rates


def _clock_metrics(clock: Clock, frames: int, simulated: float) -> dict[str, float]:
    seconds = clock.metrics()
    for kind in ("", "_elapsed"):
        run = sum(seconds[f"{phase}{kind}"] for phase in ("pair_seconds", "response_seconds", "box_seconds"))
        seconds[f"run_seconds{kind}"] = run
        if frames:
            seconds[f"pair_seconds_per_frame{kind}"] = seconds[f"pair_seconds{kind}"] / frames
            seconds[f"box_seconds_per_frame{kind}"] = seconds[f"box_seconds{kind}"] / frames
        if frames and run > 0.0:
            seconds[f"frames_per_second{kind}"] = frames / run
            seconds[f"simulated_per_second{kind}"] = simulated / run
    return seconds


def _errors(observer: Observer, answers: Answers | None, plan: Plan) -> dict[str, float]:
    errors = {"energy_drift": observer.conservation.energy_drift, "escaped": float(observer.escaped)}
    if answers is not None and answers.elastic and observer.conservation.momentum_scale > 0.0:
        errors["momentum_drift"] = answers.momentum_added / observer.conservation.momentum_scale
    if plan.keeps("penetration"):
        errors["max_penetration"] = observer.max_penetration
    return errors


def _trace(scene: Scene, flight: Flight, observer: Observer, end: float, counted: dict[str, float]) -> Trace | None:
    if observer.log is None:
        return None
    flight.move_to(end)
    velocities = flight.velocities_at(end)
    return Trace(
        *observer.log.arrays(),
        time=end,
        positions=flight.positions.copy(),
        velocities=velocities,
        energy=energy(velocities, scene.bodies.masses),
        counters=counted,
    )
