"""OFF: vertices and polygons of any length, a line each. Colours, normals and texture coordinates are passed over.

Its first word may be missing, or stand in one line with the counts, even without a space, as some large collections do.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator

import numpy as np

from harness.errors import InputError
from harness.scene.formats.text import as_text, floats, lines, shown, whole
from harness.scene.polygon_mesh import MAX_FACES, MAX_VERTICES, PolygonMesh

# C colours, N normals, ST texture coordinates, 4 four coordinates, n a number of coordinates that the next line says
KEYWORD = re.compile(rb"(?i:st)?[Cc]?N?(4?n?)(?i:off)")
BINARY = re.compile(rb"\s*\w*OFF\s+BINARY", re.IGNORECASE)


def read_off(content: bytes) -> PolygonMesh:
    """The polygons of an OFF file.

    Raises
    ------
    InputError
        If a line is wrong, or the file ends too early.
    """
    if BINARY.match(content):
        raise InputError("this is binary OFF, which is not read; save it as text")
    text = as_text(content)
    rows = ((number, words) for number, line in lines(text) if (words := line.split()))
    line, vertex_count, face_count = _counts(rows)
    if not face_count:
        raise InputError("the mesh is empty: it has no faces")
    if vertex_count > MAX_VERTICES or face_count > MAX_FACES:
        raise InputError(
            f"line {line}: its header announces {vertex_count} vertices and {face_count} faces; "
            f"at most {MAX_VERTICES} and {MAX_FACES} are read"
        )
    coordinates, corners, lengths = array("d"), array("q"), array("q")
    vertex_lines, face_lines = array("q"), array("q")
    for vertex in range(vertex_count):
        line, words = _next(rows, f"vertex {vertex + 1} of {vertex_count}")
        point = floats(words[:3], line)
        if len(point) < 3:
            raise InputError(f"line {line}: a vertex has 3 coordinates, not {len(point)}")
        coordinates.extend(point)
        vertex_lines.append(line)
    for face in range(face_count):
        line, words = _next(rows, f"face {face + 1} of {face_count}")
        length = whole(words[0], line, "a number of corners")
        if not 0 <= length < len(words):
            raise InputError(f"line {line}: a face of {length} corners is followed by {len(words) - 1} numbers")
        corners.extend([whole(word, line, "the number of a vertex") for word in words[1 : length + 1]])
        lengths.append(length)
        face_lines.append(line)
    return PolygonMesh(
        np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        np.frombuffer(corners, np.int64),
        np.frombuffer(lengths, np.int64),
        vertex_line=vertex_lines.__getitem__,
        face_line=face_lines.__getitem__,
    )


def _counts(rows: Iterator[tuple[int, list[bytes]]]) -> tuple[int, int, int]:
    """The line that holds the counts, and how many vertices and faces it announces."""
    line, words = _next(rows, "its header")
    keyword = KEYWORD.match(words[0])
    if keyword:
        if keyword[1]:
            raise InputError(f"line {line}: {shown(keyword[0])}: vertices of other than three coordinates are not read")
        words = [words[0][keyword.end() :], *words[1:]]
        words = words if words[0] else words[1:]
        if not words:
            line, words = _next(rows, "its header")
    elif not words[0].isdigit():
        raise InputError(f"this is no OFF file: line {line} begins with {shown(words[0])}")
    counts = [whole(word, line, "a number of vertices or faces") for word in words[:2]]
    if len(counts) < 2 or min(counts) < 0:
        raise InputError(f"line {line}: the numbers of vertices and of faces are missing")
    return line, counts[0], counts[1]


def _next(rows: Iterator[tuple[int, list[bytes]]], where: str) -> tuple[int, list[bytes]]:
    """The next line that is not empty."""
    for row in rows:
        return row
    raise InputError(f"the file ends in {where}")
