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
from harness.measure.contacts import Contacts
from harness.measure.divergence import first_divergence
from harness.measure.matching import match
from harness.motion.hits import Trace
from harness.motion.playback import positions_at
from harness.motion.replayed import contacts_of, error_of
from harness.runner.key import sources_hash
from harness.runner.reference_cache import kept
from harness.runner.setting import build_scene
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

# Times at which the positions of two motions are compared, and positions that are held for it in all.
LOOKS, MOST_POSITIONS = 256, 2**21

Fly = Callable[[Point], Trace]


def errors(point: Point, mesh: Mesh | None, trace: Trace, fly: Fly) -> dict[str, float]:
    """The errors of a run whose experiment declares a reference.

    Parameters
    ----------
    point : with a reference
    mesh : that its scene names
    trace : every hit of the run
    fly : flies another point of the same scene, and keeps every hit
    """
    reference = reference_point(point)
    if point.motion.response == "none":
        return _replayed(point, build_scene(reference, mesh), trace, _key(reference, mesh))
    return _free_running(point, mesh, trace, lambda: fly(reference), _key(reference, mesh))


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


def _replayed(point: Point, scene: Scene, trace: Trace, key: str) -> dict[str, float]:
    duration = point.motion.duration
    assert point.reference is not None
    tolerance = point.reference.spec.tolerance

    def make() -> dict[str, Any]:
        contacts = contacts_of(scene, duration, tolerance)
        return asdict(contacts) | {"error": np.array([error_of(scene, contacts)])}

    arrays: dict[str, Any] = dict(kept(key, make))
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


def _free_running(
    point: Point, mesh: Mesh | None, trace: Trace, fly: Callable[[], Trace], key: str
) -> dict[str, float]:
    motion, bodies = point.motion, build_scene(point, mesh).bodies

    def make() -> dict[str, Any]:
        flown = fly()
        return {"times": flown.times, "bodies": flown.bodies, "walls": flown.walls}

    arrays = kept(key, make)
    reference = replace(trace, times=arrays["times"], bodies=arrays["bodies"], walls=arrays["walls"])
    parted = min(
        motion.duration,
        first_divergence(
            len(bodies), reference.times, reference.bodies, reference.walls, trace.times, trace.bodies, trace.walls
        ),
    )
    looks = min(LOOKS, MOST_POSITIONS // max(1, len(bodies)))
    times = motion.duration * np.arange(1, looks + 1) / looks
    times = times[(times < parted) & (times <= trace.time)]
    metrics = {"divergence_time": parted}
    if len(times) and len(bodies):
        ours, theirs = (
            positions_at(times, bodies, run, motion.response, motion.restitution) for run in (trace, reference)
        )
        metrics["position_error"] = float(np.linalg.norm(ours - theirs, axis=2).max())
    return metrics
