"""Reads a mesh file, refuses what is no three-dimensional triangle surface, and normalises the rest.

trimesh parses; nothing it can say is shown raw. The file is handed over as bytes, so that it cannot name other files.
A mesh from a stranger is better read through `mesh_child`, which limits memory and time.
"""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.bounding_sphere import bounding_sphere
from harness.scene.hull import convex_hull
from harness.scene.mesh import Mesh, digest
from harness.scene.topology import Topology, area, is_convex, topology

FORMATS = ("glb", "obj", "off", "ply", "stl")
MAX_BYTES = 512 * 1024**2
MAX_FACES = 2_000_000
MAX_VERTICES = 3 * MAX_FACES  # as many as STL writes
# Below this, of its largest extent, a mesh is flat; above it every computation here keeps some digits.
FLAT = 1e-9
EXTENTS = (1e-100, 1e100)


def read_mesh(path: Path | str) -> Mesh:
    """The mesh in a file, normalised.

    Parameters
    ----------
    path : a file in one of `FORMATS`, told by its extension

    Returns
    -------
    Mesh
        With the file's faces, all of them and in their order; equal vertices are made one and unused ones left out.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is no surface with an extent in three dimensions; the file's name first.
    MemoryError
        If memory ran out while parsing it.
    """
    path = Path(path)
    try:
        return make_mesh(path.name, *_parse(path))
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error


def make_mesh(name: str, vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Mesh:
    """The mesh of arrays, validated and normalised.

    Parameters
    ----------
    name : what to call it
    vertices : (v, 3) float array, any unit
    faces : (f, 3) int array

    Raises
    ------
    InputError
        If they are no surface with an extent in three dimensions.
    """
    vertices, faces = _checked(np.asarray(vertices), np.asarray(faces))
    vertices, faces = _welded(vertices, faces)
    vertices, extent = _unit_box(vertices)
    hull = convex_hull(vertices)
    centre, radius = bounding_sphere(hull.vertices)
    vertices = np.ascontiguousarray((vertices - centre) / (2 * radius))
    hull = convex_hull(vertices)
    areas = area(vertices, faces)
    if not areas.sum() > 0:
        raise InputError("all faces of the mesh are degenerate: it has no area")
    about = topology(faces, len(vertices))
    vertices.setflags(write=False)
    faces.setflags(write=False)
    return Mesh(
        name=name,
        vertices=vertices,
        faces=faces,
        hull=hull,
        digest=digest(vertices, faces),
        watertight=about.watertight,
        convex=is_convex(vertices, faces, hull),
        notes=_notes(about, int((areas == 0).sum())),
        diameter=2 * radius * extent,
    )


def _parse(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Vertices and faces as the file has them."""
    form = path.suffix.lower().lstrip(".")
    if form not in FORMATS:
        known = ", ".join(f".{name}" for name in FORMATS)
        raise InputError(f"no mesh file: its name must end in one of {known}")
    try:
        if not path.is_file():
            raise InputError("there is no such mesh file")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(f"{size / 1024**2:.0f} MiB long; meshes of up to {MAX_BYTES // 1024**2} MiB are read")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}") from error
    declared = _declared(form, content)
    if declared > MAX_VERTICES:
        raise InputError(f"its header announces {declared} vertices or faces; at most {MAX_FACES} faces are read")
    if form in ("obj", "off"):  # text in any encoding; only the comments are not ASCII
        content = content.decode("utf-8", "replace").encode()
    try:
        mesh = trimesh.load_mesh(io.BytesIO(content), file_type=form, process=False, maintain_order=True)
    except MemoryError:
        raise
    except Exception as error:  # whatever a parser trips over, the file is at fault
        if isinstance(error.__context__, MemoryError):
            raise MemoryError from error
        reason = "" if isinstance(error, ImportError) else " ".join(str(error).split())[:200]
        raise InputError(f"not a readable {form} file" + (f" ({reason})" if reason else "")) from error
    if not hasattr(mesh, "faces"):
        raise InputError("the mesh is empty: it has no faces")
    return mesh.vertices, mesh.faces


def _declared(form: str, content: bytes) -> int:
    """The most elements of a kind that a file's header announces, before anything is allocated for them; 0 if none."""
    if form == "ply":
        counts = re.findall(rb"element\s+\w+\s+(\d+)", content[:65536])
    elif form == "off":
        counts = re.findall(rb"\d+", re.sub(rb"#[^\n]*", b"", content[:65536]))[:2]
    elif form == "stl" and not content.lstrip().startswith(b"solid"):
        return int.from_bytes(content[80:84], "little")
    else:
        counts = []
    return max((int(digits[:18]) for digits in counts), default=0)


def _checked(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The arrays, if their numbers make sense."""
    if len(faces) == 0 or len(vertices) == 0:
        raise InputError("the mesh is empty: it has no faces")
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise InputError("the mesh is not made of triangles in three dimensions")
    if len(faces) > MAX_FACES or len(vertices) > MAX_VERTICES:
        raise InputError(f"the mesh has {len(faces)} faces and {len(vertices)} vertices; at most {MAX_FACES} are read")
    wrong = int(((faces < 0) | (faces >= len(vertices))).any(axis=1).sum())
    if wrong:
        raise InputError(f"{wrong} of the mesh's faces name a vertex that does not exist")
    vertices = np.asarray(vertices, np.float64)
    wrong = int((~np.isfinite(vertices[np.unique(faces)])).any(axis=1).sum())
    if wrong:
        raise InputError(f"{wrong} of the mesh's vertices are not finite numbers")
    return vertices, faces.astype(np.int32)


def _welded(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Used vertices only, exactly equal ones made one, in the order of their first use in the file.

    Some formats (STL) write the vertices of each face anew; only welded do neighbouring faces share an edge.
    """
    used, renumbered = np.unique(faces, return_inverse=True)
    vertices = vertices[used] + 0.0  # -0.0 and 0.0 are equal, and so must be their bytes
    _, first, same = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    place = np.empty(len(order), np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    return vertices[first[order]], place[same.reshape(-1)][renumbered].reshape(-1, 3)


def _unit_box(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """The vertices moved to the origin and scaled to a largest extent of 1, and that extent; refused if flat."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    with np.errstate(over="ignore"):
        extent = float((high - low).max())
    if not EXTENTS[0] <= extent <= EXTENTS[1]:
        raise InputError(f"the mesh's extent is {extent:g}; it must be between {EXTENTS[0]:g} and {EXTENTS[1]:g}")
    vertices = (vertices - (low + (high - low) / 2)) / extent
    spread = np.linalg.svd(np.cov(vertices.T, bias=True), compute_uv=False)
    if len(vertices) < 4 or np.sqrt(spread[2] / spread[0]) < FLAT * 10:
        raise InputError("the mesh is flat: it has no extent in one direction, so no hull encloses it")
    return vertices, extent


def _notes(about: Topology, degenerate: int) -> tuple[str, ...]:
    """What a person should know of a mesh that is allowed all the same."""
    counts = (
        (about.boundary, "open: {} boundary {}", ("edge", "edges")),
        (about.crowded, "non-manifold: {} {} of more than two faces", ("edge", "edges")),
        (about.turned, "inconsistent: faces on the two sides of {} {} are turned contrary ways", ("edge", "edges")),
        (about.pieces if about.pieces > 1 else 0, "in {} {}", ("piece", "pieces that share no vertex")),
        (degenerate, "{} degenerate {} without area", ("face", "faces")),
    )
    return tuple(text.format(count, names[count > 1]) for count, text, names in counts if count)
