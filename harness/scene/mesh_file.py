"""Reads a mesh file, refuses what is no surface, and normalises the rest.

The file is taken as bytes, so that it cannot name other files, and read by its format's reader in `formats`.
A mesh that is not trusted is better read through `mesh_child`, which limits memory and time.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.bounding_sphere import bounding_sphere
from harness.scene.formats import FORMATS
from harness.scene.formats.contents import no_file, recognised
from harness.scene.hull import convex_hull, flat_hull
from harness.scene.mesh import Mesh, digest, has_area
from harness.scene.polygon_mesh import MAX_FACES, MAX_VERTICES, PolygonMesh, of_triangles, scaled
from harness.scene.topology import Topology, compact, is_own_hull, proper, topology
from harness.scene.triangulation import Triangulation, triangulated

MAX_BYTES = 512 * 1024**2
# Below this, of its largest extent, a mesh is flat; above it every computation here keeps some digits.
FLAT = 1e-9
EXTENTS = (1e-100, 1e100)
FLAT_NOTE = "flat: it encloses nothing, so that it has shape mesh alone, and no hull"
NO_AREA = "all faces of the mesh are degenerate: it has no area"


def read_mesh(path: Path | str) -> Mesh:
    """The mesh in a file, normalised.

    Parameters
    ----------
    path : a file in one of `FORMATS`, told by its extension

    Returns
    -------
    Mesh
        With the file's faces in their order, polygons cut into triangles; equal vertices are made one, and unused ones
        and faces without area are left out.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is no surface; the file's name first.
    MemoryError
        If memory ran out while reading it.
    """
    path = Path(path)
    try:
        return _made(path.name, _parsed(path))
    except InputError as error:
        said = "".join(letter if letter.isprintable() else "\ufffd" for letter in f"{path.name}: {error}")
        raise InputError(said) from error


def make_mesh(name: str, vertices: NDArray[np.float64], faces: NDArray[np.int32], notes: tuple[str, ...] = ()) -> Mesh:
    """The mesh of arrays, validated and normalised.

    Parameters
    ----------
    name : what to call it
    vertices : (v, 3) float array, any unit
    faces : (f, 3) int array
    notes : what a person should know of how they were made

    Raises
    ------
    InputError
        If they are no surface.
    """
    vertices, faces = np.asarray(vertices), np.asarray(faces)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise InputError("the mesh is not made of triangles in three dimensions")
    return _made(name, of_triangles(vertices, faces), notes)


def _parsed(path: Path) -> PolygonMesh:
    """What a file holds."""
    form = path.suffix.lower().lstrip(".")
    if form not in FORMATS:
        known = ", ".join(f".{name}" for name in FORMATS)
        raise InputError(f"no mesh file: its name must end in one of {known}")
    try:
        if reason := no_file(path):
            raise InputError(reason)
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(f"{size / 1024**2:.0f} MiB long; meshes of up to {MAX_BYTES // 1024**2} MiB are read")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}") from error
    if not content:
        raise InputError("the file is empty")
    try:
        return FORMATS[form](content)
    except InputError as error:
        what = recognised(content, form)
        raise (InputError(what) if what else error) from None


def _made(name: str, polygons: PolygonMesh, notes: tuple[str, ...] = ()) -> Mesh:
    """The mesh of polygons, validated, cut into triangles and normalised."""
    polygons = _welded(_checked(polygons))
    cut = triangulated(polygons)
    thin = ~has_area(scaled(polygons.vertices), cut.faces)
    if thin.all():
        raise InputError(NO_AREA)
    faces, used = compact(cut.faces[~thin])
    vertices = polygons.vertices[used]
    vertices, middle, extent = _unit_box(vertices)
    flat = _is_flat(vertices)
    hull_around = flat_hull if flat else convex_hull
    centre, radius = bounding_sphere(vertices if flat else hull_around(vertices).vertices)
    vertices = np.ascontiguousarray((vertices - centre) / (2 * radius))
    hull = hull_around(vertices)
    x, y, z = (middle + centre * extent).tolist()
    closed, about = faces, topology(faces, len(vertices))
    if thin.any() and not about.watertight:
        # A face without area often stands where an edge meets two others: that is no gap, though no edge is shared.
        with_thin, all_used = compact(proper(cut.faces))
        whole = topology(with_thin, len(all_used))
        if whole.watertight:
            about, closed = whole, (with_thin if len(all_used) == len(used) else faces)
    vertices.setflags(write=False)
    faces.setflags(write=False)
    return Mesh(
        name=name,
        vertices=vertices,
        faces=faces,
        hull=hull,
        digest=digest(vertices, faces),
        watertight=about.watertight,
        convex=not flat and is_own_hull(vertices, closed, hull),
        notes=(*((FLAT_NOTE,) if flat else ()), *_notes(about, cut, int(thin.sum())), *polygons.notes, *notes),
        diameter=2 * radius * extent,
        flat=flat,
        centre=(x, y, z),
    )


def _checked(mesh: PolygonMesh) -> PolygonMesh:
    """The polygons, if their numbers make sense."""
    vertices, corners, lengths = mesh.vertices, mesh.corners, mesh.lengths
    if len(lengths) == 0 or len(vertices) == 0:
        raise InputError("the mesh is empty: it has no faces")
    if (lengths < 3).all():
        raise InputError(NO_AREA)
    triangles = int(np.maximum(lengths - 2, 0).sum())
    if triangles > MAX_FACES or len(vertices) > MAX_VERTICES:
        raise InputError(f"the mesh has {triangles} faces and {len(vertices)} vertices; at most {MAX_FACES} are read")
    unknown = np.flatnonzero((corners < 0) | (corners >= len(vertices)))
    if len(unknown):
        owners = np.unique(np.searchsorted(np.cumsum(lengths), unknown, side="right"))
        where = f"line {mesh.face_line(int(owners[0]))}: " if mesh.face_line else ""
        raise InputError(
            f"{where}{len(owners)} of the mesh's faces name a vertex that does not exist, the first of them "
            f"{corners[unknown[0]] + mesh.base}; there are {len(vertices)}, counted from {mesh.base}"
        )
    used = np.unique(corners)
    infinite = used[~np.isfinite(vertices[used]).all(axis=1)]
    if len(infinite):
        where = f"line {mesh.vertex_line(int(infinite[0]))}: " if mesh.vertex_line else ""
        raise InputError(f"{where}{len(infinite)} of the mesh's vertices are not finite numbers")
    return replace(mesh, vertices=np.asarray(vertices, np.float64))


def _welded(mesh: PolygonMesh) -> PolygonMesh:
    """Used vertices only, exactly equal ones made one, in the order of their first use in the file.

    Some formats (STL) write the vertices of each face anew; only welded do neighbouring faces share an edge.
    """
    used, renumbered = np.unique(mesh.corners, return_inverse=True)
    vertices = mesh.vertices[used] + 0.0  # -0.0 and 0.0 are equal, and so must be their bytes
    _, first, same = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return replace(mesh, vertices=vertices[first[order]], corners=place[same.reshape(-1)][renumbered])


def _unit_box(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """The vertices moved to the origin and scaled to a largest extent of 1; where they were, and that extent."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    with np.errstate(over="ignore"):
        extent = float((high - low).max())
    if not EXTENTS[0] <= extent <= EXTENTS[1]:
        raise InputError(f"the mesh's extent is {extent:g}; it must be between {EXTENTS[0]:g} and {EXTENTS[1]:g}")
    middle = low + (high - low) / 2
    return (vertices - middle) / extent, middle, extent


def _is_flat(vertices: NDArray[np.float64]) -> bool:
    """Whether vertices lie in one plane, up to what a hull around them could be made of."""
    spread = np.linalg.svd(np.cov(vertices.T, bias=True), compute_uv=False)
    return len(vertices) < 4 or bool(np.sqrt(spread[2] / spread[0]) < FLAT * 10)


def _notes(about: Topology, cut: Triangulation, thin: int) -> tuple[str, ...]:
    """What a person should know of a mesh that is allowed all the same."""
    counts = (
        (about.boundary, "open: {} boundary {}", ("edge", "edges")),
        (about.nonmanifold, "non-manifold: {} {} of more than two faces", ("edge", "edges")),
        (about.turned, "inconsistent: faces on the two sides of {} {} are turned contrary ways", ("edge", "edges")),
        (about.pieces if about.pieces > 1 else 0, "in {} {}", ("piece", "pieces that share no vertex")),
        (cut.degenerate + thin, "{} degenerate {} without area left out", ("face", "faces")),
        (
            cut.bent,
            f"{{}} {{}} not plane, by up to {cut.height:.1g} of the mesh's extent",
            ("polygon is", "polygons are"),
        ),
        (cut.crossing, "{} {}", ("polygon crosses itself", "polygons cross themselves")),
    )
    return tuple(text.format(count, names[count > 1]) for count, text, names in counts if count)
