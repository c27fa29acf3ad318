"""Wavefront OBJ: vertices and polygons. Names, materials, textures, normals, lines and points are passed over.

Vertices are counted from 1, or backwards from the last one before the line. `#` begins a comment anywhere, a backslash
at the end of a line continues it, and words are separated by any white space.
"""

from __future__ import annotations

import re
from array import array

import numpy as np

from harness.errors import InputError
from harness.scene.formats.text import LARGEST, as_text, floats, gathered, rows, shown, uncommented, whole
from harness.scene.polygon_mesh import PolygonMesh

# How such a file begins.
BEGINS = rb"(?:#[^\r\n]*\s+){0,100}(?:(?:v|vn|vt|f)[ \t]+[-+.\d]|(?:mtllib|usemtl)[ \t])"
CURVED = (b"curv", b"curv2", b"surf")
OTHERS = (
    b"vt vn vp p l o g s mg usemtl mtllib maplib usemap cstype deg bmat step parm trim hole scrv sp end con bevel "
    b"c_interp d_interp lod shadow_obj trace_obj ctech stech csh"
).split()
# Lines of one kind without anything unusual, which are read together; as many as regular expressions bear.
BLOCK = re.compile(
    rb"(?P<vertices>(?:v[ \t][-+.0-9eE \t]*\n){1,1024})"
    rb"|(?P<faces>(?:f[ \t][-+/0-9 \t]*\n){1,1024})"
    rb"|(?P<others>(?:v[nt][ \t][^\n\\]*\n){1,1024})"
)
MARK = b"\xef\xbb\xbf"  # of the order of bytes
FEW = 32  # fewer lines are read faster one by one
TEXTURE_AND_NORMAL = re.compile(rb"/[^\s]*")


def read(content: bytes) -> PolygonMesh:
    """The polygons of an OBJ file.

    Raises
    ------
    InputError
        If a line of a vertex or a face is wrong, or there is no face.
    """
    return _Reader().read(as_text(content) + b"\n")


class _Reader:
    """Reads the lines of a file, blocks of them at once where they are all alike."""

    def __init__(self) -> None:
        self._coordinates, self._corners, self._lengths = array("d"), array("q"), array("q")
        self._vertex_lines, self._face_lines = array("q"), array("q")
        # others than v and f, in lower case, each with its first line and as it stands there
        self._keywords: dict[bytes, tuple[int, bytes]] = {}

    def read(self, text: bytes) -> PolygonMesh:
        if MARK in text:  # of one file behind another
            text = text.replace(b"\n" + MARK, b"\n")
        if b"\xa0" in text:  # a space that does not break, in UTF-8 and in Latin-1
            text = text.replace(b"\xc2\xa0", b" ").replace(b"\xa0", b" ")
        place, number = 0, 1
        while place < len(text):
            block = BLOCK.match(text, place)
            end = block.end() if block else _end_of_statement(text, place)
            count = text.count(b"\n", place, end)
            if not block:
                self._statement(text[place:end], number)
            elif count < FEW or not self._block(block, number, count):
                for offset, line in enumerate(block[0].splitlines()):
                    self._statement(line, number + offset)
            place, number = end, number + count
        if not self._lengths:
            raise InputError(_no_faces(len(self._vertex_lines), self._keywords))
        unknown = _unknown(self._keywords)
        return PolygonMesh(
            np.frombuffer(self._coordinates, np.float64).reshape(-1, 3),
            np.frombuffer(self._corners, np.int64),
            np.frombuffer(self._lengths, np.int64),
            base=1,
            vertex_line=self._vertex_lines.__getitem__,
            face_line=self._face_lines.__getitem__,
            notes=(f"passed over, since OBJ has no such line: {unknown}",) if unknown else (),
        )

    def _block(self, block: re.Match[bytes], first: int, count: int) -> bool:
        """Read lines of one kind; False if one of them is wrong, which reading them one by one finds."""
        if block["others"]:
            return True
        try:
            if block["vertices"]:
                values, starts, lengths = rows(block[0].replace(b"v", b""))
            else:
                values, starts, lengths = rows(TEXTURE_AND_NORMAL.sub(b"", block[0]).replace(b"f", b""))
        except ValueError:
            return False
        numbers = np.arange(first, first + count).tobytes()
        if block["vertices"]:
            if lengths.min() < 3:
                return False
            self._coordinates.frombytes(values[starts[:, None] + np.arange(3)].tobytes())
            self._vertex_lines.frombytes(numbers)
            return True
        named, vertices = values[gathered(starts, lengths)], len(self._vertex_lines)
        if (named == 0).any() or (named < -vertices).any() or (named > LARGEST).any():
            return False
        self._corners.frombytes(np.where(named > 0, named - 1, named + vertices).astype(np.int64).tobytes())
        self._lengths.frombytes(lengths.tobytes())
        self._face_lines.frombytes(numbers)
        return True

    def _statement(self, statement: bytes, number: int) -> None:
        """Read one line, or several that are joined by backslashes."""
        lines = [uncommented(line).rstrip().removesuffix(b"\\") for line in statement.splitlines()]
        words = b" ".join(lines).split()
        keyword = words[0].lower() if words else b""
        if keyword == b"v":
            point = floats(words[1:4], number)
            if len(point) < 3:
                raise InputError(f"line {number}: a vertex has 3 coordinates, not {len(point)}")
            self._coordinates.extend(point)
            self._vertex_lines.append(number)
        elif keyword in (b"f", b"fo"):  # as faces with an outline were called once
            names = [word.partition(b"/")[0] for word in words[1:]]  # vertex/texture/normal
            self._corners.extend([self._corner(name, number) for name in names])
            self._lengths.append(len(names))
            self._face_lines.append(number)
        elif keyword == b"call":
            raise InputError(f"line {number}: a file that calls another one is not read")
        elif keyword:
            self._keywords.setdefault(keyword, (number, words[0]))

    def _corner(self, name: bytes, line: int) -> int:
        """The vertex, counted from 0, that a face in a line names."""
        index, vertices = whole(name, line, "the number of a vertex"), len(self._vertex_lines)
        if index == 0:
            raise InputError(f"line {line}: a face names vertex 0; OBJ counts from 1")
        if index < -vertices:
            raise InputError(f"line {line}: a face names vertex {index}, and there are {vertices} before it")
        return index - 1 if index > 0 else vertices + index


def _end_of_statement(text: bytes, place: int) -> int:
    """The end of the line that begins at a place, with those that continue it."""
    while True:
        end = text.find(b"\n", place) + 1
        line = text[place:end].partition(b"#")[0].rstrip()
        if not line.endswith(b"\\") or end >= len(text):
            return end
        place = end


def _unknown(keywords: dict[bytes, tuple[int, bytes]]) -> str | None:
    """The first line that no OBJ file has, and how it begins."""
    for keyword, (line, word) in keywords.items():
        if keyword not in OTHERS and keyword not in CURVED:
            return f"line {line} begins with {shown(word)}"
    return None


def _no_faces(vertices: int, keywords: dict[bytes, tuple[int, bytes]]) -> str:
    """Why there is no face in a file."""
    for keyword in CURVED:
        if keyword in keywords:
            return f"line {keywords[keyword][0]}: free-form curves and surfaces are not read, and there are no faces"
    if vertices:
        others = ", lines or points" if {b"l", b"p"} & keywords.keys() else ""
        return f"the mesh is empty: it has no faces, only vertices{others}"
    unknown = _unknown(keywords)
    return f"this is no OBJ file: {unknown}" if unknown else "the mesh is empty: it has no vertices and no faces"
