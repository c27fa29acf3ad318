"""The rows of a PLY file behind its header, as text or binary: where each property stands, and its value."""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.scene.formats.ply_header import Element, Header
from harness.scene.formats.text import Numbers, as_text, gathered


class Column(NamedTuple):
    """One property in all rows of an element.

    Parameters
    ----------
    kind : type of its numbers
    starts : (n,) int array, where its number, or the first item of its list, stands in each row
    lengths : (n,) int array, of its lists; 1 for numbers
    """

    kind: str
    starts: NDArray[np.int64]
    lengths: NDArray[np.int64]


# Of a property: the type of its list's length, the widths of that and of a number, its starts and lengths if wanted.
Step: TypeAlias = "tuple[str | None, int, int, tuple[list[int], list[int]] | None]"


class Rows(ABC):
    """The rows of all elements, which must be asked for in their order. Places are counted in numbers or in bytes."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._place = 0

    @abstractmethod
    def width(self, kind: str) -> int:
        """How many places a number of a type takes."""

    @abstractmethod
    def length(self, place: int, kind: str) -> int:
        """The length of the list that stands at a place; IndexError if the file ends there."""

    @abstractmethod
    def numbers(self, places: NDArray[np.int64], kind: str) -> NDArray[np.generic]:
        """The numbers that stand at these places."""

    def line_of(self, column: Column) -> Callable[[int], int] | None:
        """Tells the line of the file in which a row has its number or list; None for a binary file."""
        return None

    def ended(self, where: str) -> InputError:
        """What to say of a file that ends in a row, or where that row ends before its last number."""
        return InputError(f"the file ends in {where}")

    @property
    @abstractmethod
    def left(self) -> tuple[int, str]:
        """How much of the file follows the rows that were asked for, and its unit."""

    def columns(self, element: Element, names: tuple[str, ...]) -> list[Column]:
        """Some of an element's properties; with that, its rows are passed.

        Raises
        ------
        InputError
            If the file ends before the last row.
        """
        if not element.rows or not element.properties:
            return [Column("f8", *np.empty((2, 0), np.int64)) for _ in names]
        even = self._even(element, names)
        return self._uneven(element, names) if even is None else even

    def values(self, column: Column) -> NDArray[np.generic]:
        """All numbers of a column, row by row."""
        width = self.width(column.kind)
        if len(column.lengths) and (column.lengths == column.lengths[0]).all():
            places = column.starts[:, None] + width * np.arange(column.lengths[0])
            return self.numbers(places.reshape(-1), column.kind)
        return self.numbers(gathered(column.starts, column.lengths, width), column.kind)

    def _even(self, element: Element, names: tuple[str, ...]) -> list[Column] | None:
        """The columns if all rows are made as the first one is; None if not, or if the file ends before."""
        place, lists = self._place, []
        columns: dict[str, tuple[str, int, int]] = {}
        for wanted in element.properties:
            length = 1
            if wanted.count is not None:
                try:
                    length = self.length(place, wanted.count)
                except IndexError:
                    return None
                lists.append((place, wanted.count, length))
                place += self.width(wanted.count)
            columns.setdefault(wanted.name, (wanted.kind, place, length))
            place += length * self.width(wanted.kind)
        stride = place - self._place
        if self._place + stride * element.rows > self._size:
            return None
        rows = stride * np.arange(element.rows)
        if any((self.numbers(start + rows, count) != length).any() for start, count, length in lists):
            return None
        self._place += stride * element.rows
        chosen = (columns[name] for name in names)
        return [Column(kind, start + rows, np.full(len(rows), length)) for kind, start, length in chosen]

    def _uneven(self, element: Element, names: tuple[str, ...]) -> list[Column]:
        """The columns, looked up row by row."""
        found: dict[str, tuple[list[int], list[int]]] = {name: ([], []) for name in names}
        steps = [
            (wanted.count, self.width(wanted.count or wanted.kind), self.width(wanted.kind), found.get(wanted.name))
            for wanted in element.properties
        ]
        place = self._place
        for row in range(element.rows):
            try:
                place = self._row(place, steps)
            except IndexError:
                raise self.ended(f"{element.name} {row + 1} of {element.rows}") from None
        self._place = place
        kinds = {wanted.name: wanted.kind for wanted in element.properties}
        return [Column(kinds[name], *np.array(found[name], np.int64)) for name in names]

    def _row(self, place: int, steps: list[Step]) -> int:
        """Take down what is wanted of the row at a place; returns the place of the next one."""
        for count, first, width, wanted in steps:
            length = 1
            if count is not None:
                length = self.length(place, count)
                place += first
            if wanted is not None:
                starts, lengths = wanted
                starts.append(place)
                lengths.append(length)
            place += length * width
        if place > self._size:
            raise IndexError
        return place


# How the length of a list is unpacked, by its type.
LETTERS = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}


class BinaryRows(Rows):
    """Rows of bytes; places are counted in bytes from the first row on."""

    def __init__(self, content: bytes, header: Header) -> None:
        super().__init__(len(content) - header.end)
        self._bytes = np.frombuffer(content, np.uint8)[header.end :]
        self._content, self._begin, self._order = content, header.end, header.order
        self._lengths = {kind: struct.Struct(header.order + letter) for kind, letter in LETTERS.items()}

    def width(self, kind: str) -> int:
        return int(kind[1])

    def length(self, place: int, kind: str) -> int:
        try:
            (length,) = self._lengths[kind].unpack_from(self._content, self._begin + place)
        except struct.error:
            raise IndexError from None
        if length < 0:
            raise InputError(f"a list of {length} numbers stands at byte {self._begin + place}")
        return int(length)

    @property
    def left(self) -> tuple[int, str]:
        return self._size - self._place, "byte"

    def numbers(self, places: NDArray[np.int64], kind: str) -> NDArray[np.generic]:
        cells = self._bytes[places[:, None] + np.arange(int(kind[1]))]
        numbers: NDArray[np.generic] = cells.view(self._order + kind).reshape(-1)
        return numbers


class TextRows(Rows):
    """Rows of text; places are counted in numbers. A row may be spread over lines."""

    def __init__(self, content: bytes, header: Header) -> None:
        self._numbers = Numbers(as_text(content[header.end :]), header.lines)
        super().__init__(len(self._numbers.values))

    def width(self, kind: str) -> int:
        return 1

    def length(self, place: int, kind: str) -> int:
        length = float(self._numbers.values[place])
        if not (length >= 0 and length.is_integer()):
            raise InputError(f"line {self._numbers.line(place)}: a list cannot have {length:g} numbers")
        return int(length)

    def numbers(self, places: NDArray[np.int64], kind: str) -> NDArray[np.generic]:
        return self._numbers.values[places]

    def line_of(self, column: Column) -> Callable[[int], int] | None:
        return lambda row: self._numbers.line(int(column.starts[row]))

    def ended(self, where: str) -> InputError:
        self._numbers.require_end()
        return InputError(f"line {self._numbers.line(self._size)}: the file ends in {where}")

    @property
    def left(self) -> tuple[int, str]:
        return self._size - self._place + self._numbers.follow, "word"
