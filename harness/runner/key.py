"""The key of a point: two points with the same key would measure the same thing, so one run serves both."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from harness.experiment.experiment import Point
from harness.installed import sources_hash
from harness.scene.scene_files import SceneFiles


def point_key(point: Point, files: SceneFiles) -> str:
    """Hash of the resolved scene, motion, engine and reference, its files' contents, and this package's sources."""
    parameters = dict(point.parameters)
    # a mesh is what is in its file, whatever that is called
    digests = dict(zip(point.scene.mesh_names, files.identities, strict=False))
    parameters["mesh"] = _renamed(parameters["mesh"], digests)
    bodies = parameters["bodies"] or ()
    parameters["bodies"] = [{**body, "mesh": _renamed(body["mesh"], digests)} for body in bodies]
    parameters["poses"] = files.poses.digest if files.poses else None
    content: dict[str, Any] = {"parameters": parameters, "sources": sources_hash()}
    if point.reference is not None:  # the same run measures more
        content["reference"] = [point.reference.spec.model_dump(), point.reference.shape]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _renamed(mesh: Any, names: Mapping[str, str]) -> Any:
    """One mesh or a choice of some, under other names."""
    if isinstance(mesh, dict):
        return {"choice": [names[name] for name in mesh["choice"]]}
    return None if mesh is None else names[mesh]
