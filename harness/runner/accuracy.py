"""What a run's hits are worth: its errors against the reference of its experiment, outside of every clock."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from harness.arrays import Floats
from harness.experiment.experiment import Point
from harness.experiment.schema import EngineSpec
from harness.motion.hits import Trace
from harness.reference.contacts import Contacts
from harness.reference.divergence import first_divergence
from harness.reference.matching import match
from harness.reference.positions_from_hits import positions_at
from harness.reference.scene_contacts import contacts_of, error_of
from harness.runner.key import sources_hash
from harness.runner.reference_cache import kept
from harness.runner.setting import build_scene
from harness.scene.box import Box
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

# Times at which the positions of two motions are compared, and positions that are held for it in all.
LOOKS, MOST_POSITIONS = 256, 2**21
# The other unit of length; no power of two, so that every number is rounded otherwise.
UNIT = math.pi / 3.0

Fly = Callable[[Point, Scene], Trace]


def errors(point: Point, mesh: Mesh | None, trace: Trace, fly: Fly) -> dict[str, float]:
    """The errors of a run whose experiment declares a reference.

    Parameters
    ----------
    point : with a reference
    mesh : that its scene names
    trace : every hit of the run
    fly : flies a point on a scene, and keeps every hit
    """
    if point.motion.response == "none":
        return _replayed(point, mesh, trace)
    return _free_running(point, mesh, trace, fly)


def reference_point(point: Point) -> Point:
    """The run that a point is measured against: predictive, of the most exact shape, at the reference's tolerance."""
    assert point.reference is not None
    spec, shape = point.reference.spec, point.reference.shape
    return replace(
        point,
        scene=point.scene.model_copy(update={"shape": shape}),
        engine=EngineSpec(algorithm=spec.algorithm, tolerance=spec.tolerance),
        reference=None,
    )


def _key(reference: Point, mesh: Mesh | None) -> str:
    """Names the reference by all that it follows from; the time step is none of it."""
    parameters = {leaf: value for leaf, value in reference.parameters.items() if leaf != "dt"}
    content = {**parameters, "mesh": mesh.digest if mesh else None, "sources": sources_hash()}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _replayed(point: Point, mesh: Mesh | None, trace: Trace) -> dict[str, float]:
    """Hits matched with the contacts of the reference."""
    reference, duration = reference_point(point), point.motion.duration

    def make() -> dict[str, Any]:
        scene = build_scene(reference, mesh)
        contacts = contacts_of(scene, duration, reference.engine.tolerance)
        return asdict(contacts) | {"error": np.array([error_of(scene, contacts)])}

    arrays: dict[str, Any] = dict(kept(_key(reference, mesh), make))
    trust = float(arrays.pop("error")[0])
    contacts = Contacts(**(arrays | {"duration": duration}))
    pair = trace.walls < 0
    until = min(duration, trace.time)
    found = match(contacts, trace.times[pair], trace.bodies[pair], until)
    metrics = {
        "reference_hits": float(found.hits),
        "reference_error": trust,
        "missed_hits": found.missed_share,
        "extra_hits": found.extra_share,
    }
    if len(found.errors):
        sizes = np.abs(found.errors)
        metrics |= {"time_error": float(np.median(sizes)), "time_error_95": float(np.quantile(sizes, 0.95))}
    if point.engine.algorithm != "predictive" and found.hits:
        metrics |= _tunnelling(contacts.lengths[contacts.begins(until)], point.motion.dt, found.missed)
    return metrics


def _tunnelling(lengths: Floats, dt: float, missed: int) -> dict[str, float]:
    """What is missed where frames come at random: a contact of length t with probability 1 - t/dt, independently."""
    chances = np.maximum(0.0, 1.0 - lengths / dt)
    excess, deviation = missed - chances.sum(), math.sqrt((chances * (1.0 - chances)).sum())
    metrics = {"missed_hits_expected": float(chances.mean())}
    if deviation > 0.0 or excess == 0.0:
        metrics["missed_hits_deviation"] = float(excess / deviation) if deviation > 0.0 else 0.0
    return metrics


def _free_running(point: Point, mesh: Mesh | None, trace: Trace, fly: Fly) -> dict[str, float]:
    """Position errors before the first hit that differs; for the reference the same against itself in other units."""
    reference = reference_point(point)
    motion, bodies = point.motion, build_scene(point, mesh).bodies
    arrays = kept(_key(reference, mesh), lambda: _both(reference, build_scene(reference, mesh), fly))
    exact, twin = (
        replace(trace, times=arrays[f"{run}_times"], bodies=arrays[f"{run}_bodies"], walls=arrays[f"{run}_walls"])
        for run in ("exact", "twin")
    )

    def parted(one: Trace, other: Trace) -> float:
        when = first_divergence(
            len(bodies), one.times, one.bodies, one.walls, other.times, other.bodies, other.walls
        )  # fmt: skip
        return min(motion.duration, when)

    metrics = {"divergence_time": parted(trace, exact), "reference_divergence_time": parted(twin, exact)}
    looks = min(LOOKS, MOST_POSITIONS // max(1, len(bodies)))
    times = motion.duration * np.arange(1, looks + 1) / looks
    times = times[(times < min(metrics.values())) & (times <= trace.time)]
    if len(times) and len(bodies):
        ours, theirs, again = (
            positions_at(times, bodies, run, motion.response, motion.restitution) for run in (trace, exact, twin)
        )
        metrics["position_error"] = float(np.linalg.norm(ours - theirs, axis=2).max())
        metrics["reference_position_error"] = float(np.linalg.norm(again - theirs, axis=2).max())
    return metrics


def _both(reference: Point, scene: Scene, fly: Fly) -> dict[str, Any]:
    """The hits of the reference, and of its twin: the same motion in another unit of length, rounded otherwise."""
    bodies = scene.bodies
    twin = replace(
        scene,
        bodies=replace(
            bodies, positions=bodies.positions * UNIT, velocities=bodies.velocities * UNIT, sizes=bodies.sizes * UNIT
        ),
        box=Box(scene.box.half * UNIT),
    )
    flown = {"exact": fly(reference, scene), "twin": fly(reference, twin)}
    return {
        f"{whose}_{name}": getattr(run, name) for whose, run in flown.items() for name in ("times", "bodies", "walls")
    }


def warm_up(scene: Scene) -> None:
    """Compile what `errors` needs for references of a scene's shape, on two bodies that meet."""
    contacts = contacts_of(scene, 1.0, 1e-6)
    match(contacts, contacts.onset, contacts.pairs[contacts.encounter], 1.0)
    events = (contacts.onset, contacts.pairs[contacts.encounter], np.full(len(contacts), -1))
    first_divergence(len(scene.bodies), *events, *events)
    trace = Trace(*events, 1.0, scene.bodies.positions, scene.bodies.velocities, 0.0, {})
    positions_at(np.ones(1), scene.bodies, trace, "elastic", 1.0)
