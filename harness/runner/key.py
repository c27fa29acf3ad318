"""The key of a point: two points with the same key would measure the same thing, so one run serves both."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from harness.experiment.experiment import Point
from harness.scene.mesh import Mesh


def point_key(point: Point, mesh: Mesh | None) -> str:
    """Hash of the resolved scene, motion, engine and reference, the mesh's contents, and this package's sources."""
    parameters = dict(point.parameters)
    parameters["mesh"] = mesh.digest if mesh else None
    content: dict[str, Any] = {"parameters": parameters, "sources": sources_hash()}
    if point.reference is not None:  # the same run measures more
        content["reference"] = [point.reference.spec.model_dump(), point.reference.shape]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


@cache
def sources_hash() -> str:
    package = Path(__file__).resolve().parents[1]
    content = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        content.update(f"{file.relative_to(package).as_posix()}\n".encode())
        content.update(file.read_bytes())
    return content.hexdigest()
