"""The key of a point: two points with the same key would measure the same thing, so one run serves both."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path

from harness.experiment.experiment import Point
from harness.scene.mesh import Mesh


def point_key(point: Point, mesh: Mesh | None) -> str:
    """Hash of the resolved scene, motion and engine, the contents of the mesh, and the sources of this package."""
    parameters = dict(point.parameters)
    parameters["mesh"] = mesh.digest if mesh else None
    content = json.dumps({"parameters": parameters, "sources": sources_hash()}, sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()


@cache
def sources_hash() -> str:
    package = Path(__file__).resolve().parents[1]
    content = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        content.update(f"{file.relative_to(package).as_posix()}\n".encode())
        content.update(file.read_bytes())
    return content.hexdigest()
