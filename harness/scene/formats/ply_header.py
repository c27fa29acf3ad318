"""The header of a PLY file: its form, and which elements with which properties follow."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from harness.errors import InputError
from harness.scene.formats.text import shown, whole, wide_encoding

TYPES = (
    {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
    | {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"}
    | {"int64": "i8", "uint64": "u8", "float": "f4", "double": "f8", "float32": "f4", "float64": "f8"}
)
# numpy's sign for the order of the bytes; none for text
FORMS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST = 1024**2


@dataclass(frozen=True)
class Property:
    """A number of an element, or a list of them.

    Parameters
    ----------
    name : its name
    kind : type of the number or of the list's items, as numpy writes it without the order of bytes
    count : type of the list's length; None for a number
    """

    name: str
    kind: str
    count: str | None = None


@dataclass(frozen=True)
class Element:
    """So many rows of the same properties."""

    name: str
    rows: int
    properties: list[Property] = field(default_factory=list)


@dataclass(frozen=True)
class Header:
    """What a file holds.

    Parameters
    ----------
    order : "<" or ">" for a binary file, empty for text
    elements : in the order of the file
    end : where the first row begins, in bytes
    lines : how many lines the header has
    """

    order: str
    elements: list[Element]
    end: int
    lines: int


def read_header(content: bytes) -> Header:
    """The header of a PLY file.

    Raises
    ------
    InputError
        If it is none; with the line at fault.
    """
    start = re.match(rb"(?:\xef\xbb\xbf)?ply[ \t]*(\r\n|\n|\r)", content)
    if not start and (encoding := wide_encoding(content)):
        raise InputError(f"this is {encoding} text; save it as UTF-8")
    if not start:
        raise InputError("this is no PLY file: its first line is not ply")
    newline = b"\r" if start[1] == b"\r" else b"\n"
    order: str | None = None
    elements: list[Element] = []
    place, number = start.end(), 1
    while True:
        end = content.find(newline, place, place + LONGEST)
        if end < 0:
            raise InputError("the file ends in its header: there is no end_header")
        words, place, number = content[place:end].split(), end + 1, number + 1
        keyword = words[0] if words else b"comment"
        if keyword == b"end_header":
            break
        if keyword == b"format":
            order = _order(words[1:], number)
        elif keyword == b"element":
            elements.append(_element(words[1:], number))
        elif keyword == b"property":
            if not elements:
                raise InputError(f"line {number}: a property before the first element")
            elements[-1].properties.append(_property(words[1:], number))
        elif keyword not in (b"comment", b"obj_info"):
            raise InputError(f"line {number}: {shown(keyword)} is no line of a PLY header")
    if order is None:
        raise InputError("its header has no line that begins with format")
    return Header(order, elements, place, number)


def _order(words: list[bytes], line: int) -> str:
    name = words[0].decode("ascii", "replace") if words else ""
    if name not in FORMS:
        known = ", ".join(FORMS)
        raise InputError(f"line {line}: {shown(b' '.join(words))} is no format of PLY; there are {known}")
    return FORMS[name]


def _element(words: list[bytes], line: int) -> Element:
    if len(words) < 2:
        raise InputError(f"line {line}: an element has a name and a number of rows")
    rows = whole(words[1], line, "a number of rows")
    if rows < 0:
        raise InputError(f"line {line}: an element cannot have {rows} rows")
    return Element(words[0].decode("utf-8", "replace"), rows)


def _property(words: list[bytes], line: int) -> Property:
    names = [word.decode("utf-8", "replace") for word in words]
    if len(names) >= 4 and names[0] == "list":
        count, kind = _type(names[1], line), _type(names[2], line)
        if count.startswith("f"):
            raise InputError(f"line {line}: the length of a list must be of a type of whole numbers, not {names[1]}")
        return Property(names[3], kind, count)
    if len(names) < 2 or names[0] == "list":
        raise InputError(f"line {line}: a property has a type and a name")
    return Property(names[1], _type(names[0], line))


def _type(name: str, line: int) -> str:
    if name not in TYPES:
        raise InputError(f"line {line}: {shown(name.encode())} is no type of PLY; there are {', '.join(TYPES)}")
    return TYPES[name]
