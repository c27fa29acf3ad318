"""Mesh files that are text: their lines and numbers, whatever program and system wrote them."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError

MARKS = {b"\xff\xfe\0\0": "UTF-32", b"\0\0\xfe\xff": "UTF-32", b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}
# Of every second one of a file's first bytes, how many are zero in UTF-16: all, where its letters are those of ASCII.
WIDE = 0.6
# What programs built by an old Microsoft compiler write for what is no finite number; its # begins no comment.
NOT_FINITE = re.compile(rb"\b\d\.#(?:QNAN|SNAN|IND|INF)\w*")
LARGEST = 2.0**53  # up to which a float tells whole numbers apart


def wide_encoding(content: bytes) -> str | None:
    """UTF-16 or UTF-32 if a text is in that encoding, which no mesh format is."""
    for mark, encoding in MARKS.items():
        if content.startswith(mark):
            return encoding
    head = content[:4096]
    few, many = sorted(head[start::2].count(0) for start in (0, 1))
    return "UTF-16" if few == 0 and many > WIDE * len(head) / 2 else None


def as_text(content: bytes) -> bytes:
    r"""The text of a file in any encoding that holds ASCII: lines end in \n, and no byte-order mark is left.

    Raises
    ------
    InputError
        If the encoding is another, or it is no text.
    """
    if encoding := wide_encoding(content):
        raise InputError(f"this is {encoding} text; save it as UTF-8")
    if b"\0" in content[:4096]:
        raise InputError("this is no text: it has bytes that are zero")
    content = content.removeprefix(b"\xef\xbb\xbf")
    if b"\r" in content:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return content


def uncommented(line: bytes) -> bytes:
    """A line without what follows `#`."""
    if b"#" not in line:
        return line
    return NOT_FINITE.sub(b"nan", line).partition(b"#")[0]


def floats(words: Sequence[bytes], line: int) -> list[float]:
    """Numbers, all written in one line."""
    try:
        if not any(b"_" in word for word in words):  # Python would take 1_000 for a number
            return [float(word) for word in words]
    except ValueError:
        pass
    raise InputError(f"line {line}: {shown(next(word for word in words if not is_number(word)))} is not a number")


def whole(word: bytes, line: int, what: str) -> int:
    """A whole number; `what` says what it is to be."""
    try:
        if b"_" not in word and abs(number := int(word)) < 2**62:
            return number
    except ValueError:
        pass
    raise InputError(f"line {line}: {shown(word)} is not {what}")


def is_number(word: bytes) -> bool:
    """Whether a word is a number, in any way of writing that is usual in files."""
    try:
        float(word)
    except ValueError:
        return False
    return b"_" not in word


def shown(word: bytes) -> str:
    """A word of a file as it may be printed."""
    text = word[:40].decode("utf-8", "replace")
    return '"' + "".join(letter if letter.isprintable() else "\ufffd" for letter in text) + '"'


def rows(block: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """All numbers of whole lines, each with its end, that hold finite numbers only; where each line begins, its length.

    Raises
    ------
    ValueError
        If a word is no number.
    """
    words = block.replace(b"\n", b" nan ").split()
    values = np.fromiter(map(float, words), np.float64, len(words))
    ends = np.flatnonzero(np.isnan(values))
    starts = np.concatenate([[0], ends[:-1] + 1])
    return values, starts, ends - starts


def gathered(starts: NDArray[np.int64], lengths: NDArray[np.int64], step: int = 1) -> NDArray[np.int64]:
    """The places of lists of numbers, one list after another, whose numbers lie so many places apart."""
    before = np.cumsum(lengths) - lengths
    return np.repeat(starts - step * before, lengths) + step * np.arange(int(lengths.sum()))


class Numbers:
    """The numbers at the beginning of a text, separated by any white space.

    Parameters
    ----------
    text : the text
    before : how many lines of the file stand before it

    Attributes
    ----------
    values : up to the first word that is no number
    follow : words from that one on
    """

    values: NDArray[np.float64]
    follow: int

    def __init__(self, text: bytes, before: int) -> None:
        self._text, self._before = text, before
        words = text.split()
        self.follow, self._wrong = 0, b""
        try:
            if b"_" in text:
                raise ValueError
            self.values = np.fromiter(map(float, words), np.float64, len(words))
        except ValueError:
            wrong = next(place for place, word in enumerate(words) if not is_number(word))
            self.values = np.fromiter(map(float, words[:wrong]), np.float64, wrong)
            self.follow, self._wrong = len(words) - wrong, words[wrong]

    def require_end(self) -> None:
        """Refuse a word that is no number, since more numbers are needed; with its line."""
        if self.follow:
            raise InputError(f"line {self.line(len(self.values))}: {shown(self._wrong)} is not a number")

    def line(self, place: int) -> int:
        """The line of the file in which a number stands; the last one for a place beyond the end."""
        last = self._before
        for last, line in enumerate(io.BytesIO(self._text), self._before + 1):  # noqa: B007
            place -= len(line.split())
            if place < 0:
                break
        return last
