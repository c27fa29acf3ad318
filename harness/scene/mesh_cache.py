"""Meshes kept between commands as they were read: a child process that reads files takes a third of a second.

A mesh is found by the content of its file, the sources of the reader and the versions of the libraries that it calls.
What was refused is not kept.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.installed import version_of
from harness.kept_files import keep_arrays, kept_arrays
from harness.kernel_cache import all_sources
from harness.scene.hull import Hull
from harness.scene.mesh import Mesh

KIND = "meshes"
# The largest file that this process takes in; a larger one is read by a child, with limits, each time.
MOST_BYTES = 64 * 1024**2
_LIBRARIES = ("numpy", "scipy", "manifold3d")
_ARRAYS = ("vertices", "faces", "hull_vertices", "hull_faces")


def key_of(path: Path) -> str | None:
    """What a mesh file is kept under; None for one that is not kept, as one that cannot be read."""
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return None
        content = hashlib.sha256(path.read_bytes())
    except (OSError, MemoryError):
        return None
    content.update(f"\n{path.name}\n{_reader()}".encode("utf-8", "surrogateescape"))
    return f"{content.hexdigest()[:40]}.npz"


def kept_mesh(key: str) -> Mesh | None:
    """The mesh that is kept under a key, if one is."""
    found = kept_arrays(KIND, key)
    if found is not None:
        with suppress(KeyError, ValueError, TypeError):  # of a file that something else has written
            facts = json.loads(str(found["facts"]))
            return mesh_of(facts, [found[name] for name in _ARRAYS])
    return None


def keep_mesh(key: str, mesh: Mesh) -> None:
    """Keep a mesh under a key."""
    arrays = dict(zip(_ARRAYS, arrays_of(mesh), strict=True))
    keep_arrays(KIND, key, {**arrays, "facts": np.array(json.dumps(facts_of(mesh)))})


def arrays_of(mesh: Mesh) -> list[NDArray[Any]]:
    """The arrays of a mesh, in the order in which `mesh_of` takes them."""
    return [mesh.vertices, mesh.faces, mesh.hull.vertices, mesh.hull.faces]


def facts_of(mesh: Mesh) -> dict[str, object]:
    """All else that there is to know of it, as JSON can say it."""
    return {
        "name": mesh.name,
        "digest": mesh.digest,
        "watertight": mesh.watertight,
        "convex": mesh.convex,
        "notes": mesh.notes,
        "diameter": mesh.diameter,
        "flat": mesh.flat,
        "centre": mesh.centre,
    }


def mesh_of(facts: Mapping[str, Any], arrays: Sequence[NDArray[Any]]) -> Mesh:
    """A mesh of what `facts_of` and `arrays_of` gave, its arrays read-only."""
    for array in arrays:
        array.setflags(write=False)
    vertices, faces, hull_vertices, hull_faces = arrays
    return Mesh(
        name=facts["name"],
        vertices=vertices,
        faces=faces,
        hull=Hull(hull_vertices, hull_faces),
        digest=facts["digest"],
        watertight=facts["watertight"],
        convex=facts["convex"],
        notes=tuple(facts["notes"]),
        diameter=facts["diameter"],
        flat=facts["flat"],
        centre=tuple(facts["centre"]),
    )


@cache
def _reader() -> str:
    """A hash of the sources that read meshes, and of the versions of the libraries that they call."""
    sources = hashlib.sha256()
    for file in sorted(all_sources("harness.scene.mesh_file")):
        sources.update(file.read_bytes())
    for library in _LIBRARIES:
        if version := version_of(library):
            sources.update(f"{library} {version}\n".encode())
    return sources.hexdigest()
