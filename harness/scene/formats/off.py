"""OFF: vertices and polygons of any length, a line each. Colours, normals and texture coordinates are passed over.

Its first word may be missing, or stand in one line with the counts, even without a space, as some large collections do.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable

import numpy as np

from harness.errors import InputError
from harness.scene.formats.text import LARGEST, as_text, floats, gathered, rows, shown, uncommented, whole
from harness.scene.polygon_mesh import MAX_FACES, MAX_VERTICES, PolygonMesh, beyond

# How such a file begins.
BEGINS = rb"(?:ST)?C?N?OFF\s"
# C colours, N normals, ST texture coordinates, 4 four coordinates, n a number of coordinates that the next line says
KEYWORD = re.compile(rb"(?i:st)?[Cc]?N?(4?n?)(?i:off)")
BINARY = re.compile(rb"\s*\w*OFF\s+BINARY", re.IGNORECASE)
# Lines without anything unusual, which are read together; as many as regular expressions bear.
ALIKE = rb"(?:[-+.0-9eE \t]+\n){1,%d}"
MOST = 1024


def read(content: bytes) -> PolygonMesh:
    """The polygons of an OFF file.

    Raises
    ------
    InputError
        If a line is wrong, or the file ends too early.
    """
    if BINARY.match(content):
        raise InputError("this is binary OFF, which is not read; save it as text")
    return _Reader(as_text(content)).read()


class _Reader:
    """Reads the lines of a file, blocks of them at once where they hold nothing but numbers."""

    def __init__(self, text: bytes) -> None:
        self._whole = text.endswith(b"\n")  # if not, the last line may have been cut
        self._text = text if self._whole else text + b"\n"
        self._place, self._line = 0, 0  # where the next line begins, and the number of the line before it
        self._coordinates, self._corners, self._lengths = array("d"), array("q"), array("q")
        self._vertex_lines, self._face_lines = array("q"), array("q")

    def read(self) -> PolygonMesh:
        vertices, faces = self._counts()
        if not faces:
            raise InputError("the mesh is empty: it has no faces")
        if vertices > MAX_VERTICES or faces > MAX_FACES:
            raise InputError(
                f"line {self._line}: its header announces {vertices} vertices and {faces} faces; "
                f"at most {MAX_VERTICES} and {MAX_FACES} are read"
            )
        self._elements("vertex", vertices, self._vertex_block, self._vertex)
        self._elements("face", faces, self._face_block, self._face)
        more = sum(bool(uncommented(line).strip()) for line in self._text[self._place :].splitlines())
        return PolygonMesh(
            np.frombuffer(self._coordinates, np.float64).reshape(-1, 3),
            np.frombuffer(self._corners, np.int64),
            np.frombuffer(self._lengths, np.int64),
            vertex_line=self._vertex_lines.__getitem__,
            face_line=self._face_lines.__getitem__,
            notes=beyond(more, "line", faces) if more else (),
        )

    def _elements(
        self, name: str, count: int, read_block: Callable[[bytes, int], bool], read_line: Callable[[list[bytes]], None]
    ) -> None:
        """Read so many lines, those without anything unusual in blocks."""
        done = 0
        while done < count:
            alike = re.compile(ALIKE % min(count - done, MOST)).match(self._text, self._place)
            block = alike[0] if alike else b""
            lines = block.count(b"\n")
            if alike and read_block(block, lines):
                self._place, self._line, done = alike.end(), self._line + lines, done + lines
                continue
            for _ in range(min(max(1, lines), count - done)):
                element = f"{name} {done + 1} of {count}"
                words = self._words(element)
                try:
                    read_line(words)
                except InputError:
                    if self._whole or self._text[self._place :].strip():
                        raise
                    raise InputError(f"line {self._line}: the file ends in {element}") from None
                done += 1

    def _words(self, where: str) -> list[bytes]:
        """The words of the next line that has any."""
        while self._place < len(self._text):
            end = self._text.index(b"\n", self._place)
            words = uncommented(self._text[self._place : end]).split()
            self._place, self._line = end + 1, self._line + 1
            if words:
                return words
        raise InputError(f"line {self._line}: the file ends in {where}")

    def _counts(self) -> tuple[int, int]:
        """How many vertices and faces the header announces."""
        words = self._words("its header")
        keyword = KEYWORD.match(words[0])
        if keyword:
            if keyword[1]:
                raise InputError(f"{shown(keyword[0])}: vertices of other than three coordinates are not read")
            words[0] = words[0][keyword.end() :]
            words = [word for word in words if word] or self._words("its header")
        elif not words[0].isdigit():
            raise InputError(f"this is no OFF file: line {self._line} begins with {shown(words[0])}")
        counts = [whole(word, self._line, "a number of vertices or faces") for word in words[:2]]
        if len(counts) < 2 or min(counts) < 0:
            raise InputError(f"line {self._line}: the numbers of vertices and of faces are missing")
        return counts[0], counts[1]

    def _vertex(self, words: list[bytes]) -> None:
        point = floats(words[:3], self._line)
        if len(point) < 3:
            raise InputError(f"line {self._line}: a vertex has 3 coordinates, not {len(point)}")
        self._coordinates.extend(point)
        self._vertex_lines.append(self._line)

    def _face(self, words: list[bytes]) -> None:
        length = whole(words[0], self._line, "a number of corners")
        if not 0 <= length < len(words):
            raise InputError(f"line {self._line}: a face of {length} corners is followed by {len(words) - 1} numbers")
        corners = [whole(word, self._line, "the number of a vertex") for word in words[1 : length + 1]]
        self._corners.extend(corners)
        self._lengths.append(length)
        self._face_lines.append(self._line)

    def _vertex_block(self, block: bytes, lines: int) -> bool:
        """Read vertices; False if a line is wrong, which reading them one by one finds."""
        try:
            values, starts, lengths = rows(block)
        except ValueError:
            return False
        if lengths.min() < 3:
            return False
        self._coordinates.frombytes(values[starts[:, None] + np.arange(3)].tobytes())
        self._vertex_lines.frombytes(np.arange(self._line + 1, self._line + 1 + lines).tobytes())
        return True

    def _face_block(self, block: bytes, lines: int) -> bool:
        """As `_vertex_block`, of faces."""
        try:
            values, starts, lengths = rows(block)
        except ValueError:
            return False
        counts = values[starts]  # NaN, the end of the line, where it is empty
        if not ((counts >= 0) & (counts < lengths) & (counts == np.floor(counts))).all():
            return False
        named = values[gathered(starts + 1, counts.astype(np.int64))]
        if ((named != np.floor(named)) | (np.abs(named) > LARGEST)).any():
            return False
        self._corners.frombytes(named.astype(np.int64).tobytes())
        self._lengths.frombytes(counts.astype(np.int64).tobytes())
        self._face_lines.frombytes(np.arange(self._line + 1, self._line + 1 + lines).tobytes())
        return True
