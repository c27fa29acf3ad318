"""Wavefront OBJ: vertices and polygons. Names, materials, textures, normals, lines and points are passed over.

Vertices are counted from 1, or backwards from the last one before the line. `#` begins a comment anywhere, a backslash
at the end of a line continues it, and words are separated by any white space.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from harness.errors import InputError
from harness.scene.formats.text import as_text, floats, lines, shown, whole
from harness.scene.polygon_mesh import PolygonMesh

CURVED = (b"curv", b"curv2", b"surf")
OTHERS = (
    b"vt vn vp p l o g s mg usemtl mtllib maplib usemap cstype deg bmat step parm trim hole scrv sp end con bevel "
    b"c_interp d_interp lod shadow_obj trace_obj ctech stech"
).split()


def read_obj(content: bytes) -> PolygonMesh:
    """The polygons of an OBJ file.

    Raises
    ------
    InputError
        If a line of a vertex or a face is wrong, or there is no face.
    """
    coordinates, corners, lengths = array("d"), array("q"), array("q")
    vertex_lines, face_lines = array("q"), array("q")
    keywords: dict[bytes, int] = {}
    for number, line in _statements(as_text(content)):
        words = line.split()
        if not words:
            continue
        keyword = words[0].lower()
        if keyword == b"v":
            point = floats(words[1:4], number)
            if len(point) < 3:
                raise InputError(f"line {number}: a vertex has 3 coordinates, not {len(point)}")
            coordinates.extend(point)
            vertex_lines.append(number)
        elif keyword == b"f":
            face = _corners(words[1:], number, len(vertex_lines))
            corners.extend(face)
            lengths.append(len(face))
            face_lines.append(number)
        elif keyword == b"call":
            raise InputError(f"line {number}: a file that calls another one is not read")
        elif keyword not in keywords:
            keywords[keyword] = number
    if not lengths:
        raise InputError(_no_faces(len(vertex_lines), keywords))
    return PolygonMesh(
        np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        np.frombuffer(corners, np.int64),
        np.frombuffer(lengths, np.int64),
        base=1,
        vertex_line=vertex_lines.__getitem__,
        face_line=face_lines.__getitem__,
    )


def _statements(text: bytes) -> Iterator[tuple[int, bytes]]:
    """Each statement with the number of the line in which it begins."""
    if b"\xa0" in text:  # a space that does not break, in UTF-8 and in Latin-1
        text = text.replace(b"\xc2\xa0", b" ").replace(b"\xa0", b" ")
    if b"\\" not in text:
        yield from lines(text)
        return
    begun = 0
    parts: list[bytes] = []
    for number, line in lines(text):
        begun = begun if parts else number
        line = line.rstrip()
        parts.append(line.removesuffix(b"\\"))
        if not line.endswith(b"\\"):
            yield begun, b" ".join(parts)
            parts = []
    if parts:
        yield begun, b" ".join(parts)


def _corners(words: list[bytes], line: int, vertices: int) -> list[int]:
    """The vertices, counted from 0, of a face that stands after so many vertices."""
    names = [word.partition(b"/")[0] for word in words]  # vertex/texture/normal
    try:
        found = [int(name) for name in names]
    except ValueError:
        found = [0]
    if 0 < min(found, default=1) <= max(found, default=1) < 2**62 and b"_" not in b"".join(names):
        return [index - 1 for index in found]
    found = [whole(name, line, "the number of a vertex") for name in names]
    if 0 in found:
        raise InputError(f"line {line}: a face names vertex 0; OBJ counts from 1")
    if min(found) < -vertices:
        raise InputError(f"line {line}: a face names vertex {min(found)}, and there are {vertices} before it")
    return [index - 1 if index > 0 else vertices + index for index in found]


def _no_faces(vertices: int, keywords: dict[bytes, int]) -> str:
    """Why there is no face in a file."""
    for keyword in CURVED:
        if keyword in keywords:
            return f"line {keywords[keyword]}: free-form curves and surfaces are not read, and there are no faces"
    if vertices:
        others = ", lines or points" if {b"l", b"p"} & keywords.keys() else ""
        return f"the mesh is empty: it has no faces, only vertices{others}"
    unknown = [keyword for keyword in keywords if keyword not in OTHERS]
    if unknown:
        return f"this is no OBJ file: line {keywords[unknown[0]]} begins with {shown(unknown[0])}"
    return "the mesh is empty: it has no vertices and no faces"
