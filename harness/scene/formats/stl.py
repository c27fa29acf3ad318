"""STL: triangles, each with vertices of its own, binary or as text. Normals and attributes are passed over.

A file is binary if it is as long as its number of faces says, or longer, whatever its first 80 bytes are: many begin
with `solid`. In text, keywords stand in any case, and lines before the first of them or between facets are passed over.
"""

from __future__ import annotations

import io
import re
from array import array

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.formats.text import as_text, floats, shown, wide_encoding
from harness.scene.polygon_mesh import MAX_FACES, PolygonMesh, beyond

# How such a file begins.
BEGINS = rb"(?is)solid\b.{0,2000}\bfacet\s+normal\b"
HEADER = 84
FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
KEYWORDS = {b"facet", b"outer", b"vertex", b"endloop", b"endfacet", b"solid", b"endsolid"}
# The words of a facet where nothing is unusual, None for numbers; and the columns of its vertices' coordinates.
REGULAR = [
    word if word.isalpha() else None
    for word in b"facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet".split()
]
NUMBERS = [column for column, word in enumerate(REGULAR) if word is None][3:]  # behind those of the normal
BLOCK = 1_000_000  # bytes of text that are looked at together
CONTROL = re.compile(rb"[\0-\x08\x0e-\x19]")  # bytes that no text has


def read(content: bytes) -> PolygonMesh:
    """The triangles of an STL file; in text, a loop of more than three vertices is a polygon.

    Raises
    ------
    InputError
        If the file ends too early, or is text that is not STL.
    """
    announced = int.from_bytes(content[80:HEADER], "little")
    if len(content) >= HEADER + announced * FACE.itemsize:
        return _read_binary(content, announced)
    if wide_encoding(content) or not CONTROL.search(content[:4096]):
        text = as_text(content)
        return _read_regular(text) or _TextReader().read(text)
    if len(content) < HEADER:
        raise InputError(f"the file ends before its first face: it is {len(content)} bytes long")
    if announced > MAX_FACES:
        raise InputError(f"its header announces {announced} faces; at most {MAX_FACES} are read")
    raise InputError(f"the file ends in face {(len(content) - HEADER) // FACE.itemsize + 1} of {announced}")


def is_binary(content: bytes) -> bool:
    """Whether a file is exactly as long as binary STL of the number of faces that it announces."""
    announced = int.from_bytes(content[80:HEADER], "little")
    return announced > 0 and len(content) == HEADER + announced * FACE.itemsize


def _read_binary(content: bytes, count: int) -> PolygonMesh:
    if count == 0:
        more = len(content) - HEADER
        raise InputError("its header announces 0 faces" + (f", and {more} bytes follow" if more else ""))
    if count > MAX_FACES:
        raise InputError(f"its header announces {count} faces; at most {MAX_FACES} are read")
    faces = np.frombuffer(content, FACE, count, HEADER)
    vertices = faces["corners"].reshape(-1, 3).astype(np.float64)
    more = len(content) - HEADER - count * FACE.itemsize
    notes = beyond(more, "byte", count) if more else ()
    return PolygonMesh(vertices, np.arange(3 * count), np.full(count, 3), notes=notes)


def _read_regular(text: bytes) -> PolygonMesh | None:
    """The triangles of a text in which nothing is unusual, many at once; None of any other text."""
    text = text.lower()
    coordinates, place = array("d"), 0
    while (named := text.find(b"solid", place)) >= 0:
        start, end = text.rfind(b"\n", place, named) + 1, text.find(b"\n", named)
        word = text[start:named].strip()
        if word not in (b"", b"end"):
            return None
        while place < start:
            stop = text.find(b"endfacet", min(place + BLOCK, start), start)
            stop = start if stop < 0 else stop + len(b"endfacet")
            points = _regular_facets(text[place:stop])
            if points is None:
                return None
            coordinates.frombytes(points.tobytes())
            place = stop
        place = end if end >= 0 else len(text)
    if not coordinates or word != b"end" or text[place:].strip():
        return None
    vertices = np.frombuffer(coordinates, np.float64).reshape(-1, 3)
    return PolygonMesh(vertices, np.arange(len(vertices)), np.full(len(vertices) // 3, 3))


def _regular_facets(facets: bytes) -> NDArray[np.float64] | None:
    """(n, 9) float array, the coordinates of facets, if they are all as they should be."""
    words, width = facets.split(), len(REGULAR)
    count = len(words) // width
    if len(words) % width or b"_" in facets:  # Python would take 1_000 for a number
        return None
    if any(words[column::width] != [word] * count for column, word in enumerate(REGULAR) if word):
        return None
    try:
        points = np.array([list(map(float, words[column::width])) for column in NUMBERS]).T
    except ValueError:
        return None
    return points if np.isfinite(points).all() else None


class _TextReader:
    """Reads any text, word by word, since all of it may stand in one line."""

    def __init__(self) -> None:
        self._coordinates, self._lengths = array("d"), array("q")
        self._vertex_lines, self._face_lines = array("q"), array("q")
        self._facet = 0  # the line in which the facet began, while inside one
        self._loop = -1  # the number of the loop's first vertex, while inside one
        self._last = b""  # the last of `solid` and `endsolid`

    def read(self, text: bytes) -> PolygonMesh:
        number = 0
        for number, line in enumerate(io.BytesIO(text), 1):
            words = line.split()
            place = 0
            while place < len(words):
                try:
                    place = self._step(words, place, number)
                except InputError:
                    if text.count(b"\n", 0, len(text.rstrip())) + 1 > number or b"endsolid" in text[-200:].lower():
                        raise
                    break  # the last line, in the middle of a face
        if self._facet:
            raise InputError(f"line {number}: the file ends in face {len(self._lengths) + 1}")
        if not self._lengths:
            if not self._last:
                raise InputError("this is no STL file: no line of it begins a solid or a facet")
            raise InputError("the mesh is empty: it has no faces")
        vertices = np.frombuffer(self._coordinates, np.float64).reshape(-1, 3)
        return PolygonMesh(
            vertices,
            np.arange(len(vertices)),
            np.frombuffer(self._lengths, np.int64),
            vertex_line=self._vertex_lines.__getitem__,
            face_line=self._face_lines.__getitem__,
            notes=() if self._last == b"endsolid" else ("no endsolid at its end: the file may have been cut",),
        )

    def _step(self, words: list[bytes], place: int, line: int) -> int:
        """Take one keyword and what belongs to it; returns the place of the next one."""
        word = words[place].lower()
        if word == b"vertex" and self._loop >= 0:
            point = floats(words[place + 1 : place + 4], line)
            if len(point) < 3:
                raise InputError(f"line {line}: a vertex has 3 coordinates, not {len(point)}")
            self._coordinates.extend(point)
            self._vertex_lines.append(line)
            return place + 4
        if word == b"outer" and self._facet and self._loop < 0:
            self._loop = len(self._vertex_lines)
            return place + 2
        if word == b"endloop" and self._loop >= 0:
            self._lengths.append(len(self._vertex_lines) - self._loop)
            self._face_lines.append(self._facet)
            self._loop = -1
            return place + 1
        if word == b"endfacet" and self._facet and self._loop < 0:
            self._facet = 0
            return place + 1
        if word.startswith(b"#"):
            return len(words)
        if self._facet:
            raise InputError(f"line {line}: {shown(words[place])} inside of face {len(self._lengths) + 1}")
        if word == b"facet":
            self._facet = line
            while place + 1 < len(words) and words[place + 1].lower() not in KEYWORDS:  # the normal
                place += 1
            return place + 1
        if word in (b"solid", b"endsolid"):
            self._last = word
            # A name takes the rest of the line, unless facets follow in it.
            rest = [other.lower() for other in words[place:]]
            for follower in range(1, len(rest) - 1):
                if rest[follower : follower + 2] == [b"facet", b"normal"]:
                    return place + follower
        return len(words)
