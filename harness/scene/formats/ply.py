"""PLY: the elements `vertex` and `face` of a file, as text or binary in either order of bytes.

Lists of any length are read, mixed as they come. Other elements and properties are passed over, and what stands behind
the last needed element is not looked at.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.formats.ply_header import Element, Header, read_header
from harness.scene.formats.ply_rows import BinaryRows, Column, Rows, TextRows
from harness.scene.formats.text import LARGEST
from harness.scene.polygon_mesh import MAX_FACES, MAX_VERTICES, PolygonMesh, beyond

# How such a file begins.
BEGINS = rb"ply[ \t]*[\r\n]"
CORNERS = ("vertex_indices", "vertex_index")
COORDINATES = ("x", "y", "z")
MOST = {"vertex": MAX_VERTICES, "face": MAX_FACES}


def read(content: bytes) -> PolygonMesh:
    """The polygons of a PLY file.

    Raises
    ------
    InputError
        If the header or a row is wrong, the file ends too early, or there are no faces.
    """
    header = read_header(content)
    _require_faces(header)
    rows: Rows = BinaryRows(content, header) if header.order else TextRows(content, header)
    found: dict[str, list[Column]] = {}
    for element in header.elements:
        if len(found) == len(MOST):
            break
        if element.name not in MOST or element.name in found:
            rows.columns(element, ())
        else:
            wanted = COORDINATES if element.name == "vertex" else (_corners(element),)
            found[element.name] = rows.columns(element, wanted)
    vertices, (faces,) = found["vertex"], found["face"]
    with np.errstate(over="ignore"):  # what is too large for the type that the header names is infinite, and refused
        points = [rows.values(column).astype(column.kind).astype(np.float64) for column in vertices]
    more, unit = rows.left
    return PolygonMesh(
        np.column_stack(points),
        _vertex_numbers(rows, faces),
        faces.lengths,
        vertex_line=rows.line_of(vertices[0]),
        face_line=rows.line_of(faces),
        notes=beyond(more, unit, len(faces.lengths)) if more and header.elements[-1].name == "face" else (),
    )


def _require_faces(header: Header) -> None:
    """Refuse what is no mesh, or one whose faces are written in another way, before its rows are looked at."""
    elements = {element.name: element for element in reversed(header.elements)}
    for name in ("tristrips", "tristrip"):
        if name in elements and elements[name].rows:
            raise InputError("its faces are triangle strips, which are not read")
    for name, most in MOST.items():
        if name not in elements or not elements[name].rows:
            other = "only vertices" if name == "face" and "vertex" in elements else "no vertices"
            raise InputError(f"the mesh is empty: it has no faces, {other}")
        if elements[name].rows > most:
            raise InputError(f"its header announces {elements[name].rows} of {name}; at most {most} are read")
    numbers = {kind.name for kind in elements["vertex"].properties if kind.count is None}
    for name in COORDINATES:
        if name not in numbers:
            raise InputError(f"its vertices have no property {name}")
    _corners(elements["face"])


def _corners(element: Element) -> str:
    """The name of the list of a face's corners."""
    for kind in element.properties:
        if kind.name in CORNERS and kind.count is not None:
            return kind.name
    raise InputError(f"its faces have no list of corners, {' or '.join(CORNERS)}")


def _vertex_numbers(rows: Rows, faces: Column) -> NDArray[np.int64]:
    """The corners of all faces, if they are whole numbers; that there are such vertices is checked elsewhere."""
    values = rows.values(faces)
    if values.dtype.kind != "f":
        return values.astype(np.int64)
    fractional = np.flatnonzero(~(np.abs(values) < LARGEST) | (values != np.floor(values)))
    if len(fractional):
        first = int(fractional[0])
        face = int(np.searchsorted(np.cumsum(faces.lengths), first, side="right"))
        line = rows.line_of(faces)
        where = f"line {line(face)}: " if line else ""
        raise InputError(f"{where}face {face + 1} names vertex {values[first]:g}, which is no whole number")
    return values.astype(np.int64)
