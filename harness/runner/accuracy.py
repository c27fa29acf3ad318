"""The errors of a run whose experiment declares a reference, measured outside of every clock."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from harness.experiment.experiment import Point
from harness.experiment.schema import EngineSpec
from harness.installed import sources_hash
from harness.motion.answers import NearAnswers
from harness.motion.hits import Trace
from harness.reference.contacts import Contacts
from harness.reference.events import Events
from harness.reference.gap_errors import gap_errors
from harness.reference.hit_errors import hit_errors
from harness.reference.late_hits import late_hits
from harness.reference.near_pairs import NearReference, near_reference
from harness.reference.position_errors import ReferenceEvents, in_another_unit, position_errors
from harness.reference.scene_contacts import onset_error, scene_contacts
from harness.runner.point import is_stepped, law_of
from harness.runner.reference_cache import kept
from harness.runner.scene_of_point import build_scene
from harness.scene.scene import Scene
from harness.scene.scene_files import SceneFiles

Fly = Callable[[Point, Scene], Trace]


def near_errors(point: Point, files: SceneFiles, answers: NearAnswers) -> dict[str, float]:
    """The errors of a run that was asked about near pairs.

    Parameters
    ----------
    point : with a reference
    files : that its scene names
    answers : of the run
    """
    reference, within = reference_point(point), point.engine.within or 0.0
    scene = build_scene(reference, files)
    law = law_of(point, scene)

    def make() -> dict[str, Any]:
        return asdict(near_reference(scene, law, within))

    arrays: dict[str, Any] = dict(kept(_key(reference, files, within=within, dt=point.motion.dt), make))
    return gap_errors(scene, law, NearReference(**arrays), answers, within)


def errors(point: Point, files: SceneFiles, trace: Trace, fly: Fly) -> dict[str, float]:
    """The errors of a run.

    Parameters
    ----------
    point : with a reference
    files : that its scene names
    trace : every hit of the run
    fly : flies a point on a scene, and keeps every hit
    """
    reference, motion = reference_point(point), point.motion
    if motion.response != "none":
        bodies, exact = build_scene(point, files).bodies, _reference_events(reference, files, fly)
        return position_errors(bodies, trace, exact, motion.duration, motion.response, motion.restitution)
    contacts, error = _reference_contacts(reference, files)
    impacts = point.engine.query == "impact"
    found = hit_errors(contacts, error, trace, motion.dt if is_stepped(point) and not impacts else None)
    if impacts:
        late = late_hits(
            build_scene(reference, files), contacts, trace, point.engine.tolerance, reference.engine.tolerance
        )
        found |= {} if late is None else {"late_hits": late}
    return found


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


def _reference_contacts(reference: Point, files: SceneFiles) -> tuple[Contacts, float]:
    """Every contact of a motion without response, and the error of their onsets (s)."""
    duration = reference.motion.duration

    def make() -> dict[str, Any]:
        scene = build_scene(reference, files)
        contacts = scene_contacts(scene, duration, reference.engine.tolerance)
        return asdict(contacts) | {"error": np.array([onset_error(scene, contacts)])}

    arrays: dict[str, Any] = dict(kept(_key(reference, files), make))
    error = float(arrays.pop("error")[0])
    return Contacts(**(arrays | {"duration": duration})), error


def _reference_events(reference: Point, files: SceneFiles, fly: Fly) -> ReferenceEvents:
    """Every hit of a motion with response, and of its twin."""

    def make() -> dict[str, Any]:
        scene = build_scene(reference, files)
        runs = {"exact": fly(reference, scene), "twin": fly(reference, in_another_unit(scene))}
        return {f"{run}_{name}": getattr(hits, name) for run, hits in runs.items() for name in Events._fields}

    arrays = kept(_key(reference, files), make)
    return ReferenceEvents(
        *(Events(*(arrays[f"{run}_{name}"] for name in Events._fields)) for run in ReferenceEvents._fields)
    )


def _key(reference: Point, files: SceneFiles, **more: float) -> str:
    """Names the reference by all that it follows from; the time step is none of it, but where `more` has it."""
    parameters = {leaf: value for leaf, value in reference.parameters.items() if leaf != "dt"}
    content = {**parameters, **more, "files": files.identities, "sources": sources_hash()}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
