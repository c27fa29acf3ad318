"""Text that fits the terminal, or as many columns as the variable COLUMNS asks for; elsewhere a line stays a line."""

from __future__ import annotations

import argparse
import os
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator

_LEAST = 24  # columns that a last column of a table needs to be one
_CONTROLS = frozenset(map(chr, range(0x7F, 0xA0)))
_HANGING = 4  # columns by which the rest of a line is indented, where it cannot stand below the last column


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Keeps tables and blank lines of a description, and fills its paragraphs."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return textwrap.indent("\n".join(_filled(text.splitlines(), width)), indent)


def columns() -> int | None:
    """How wide what is printed may be; None if it is not for a terminal and nothing else asks for a width."""
    if not sys.stdout.isatty() and not os.environ.get("COLUMNS", "").isdecimal():
        return None
    return max(1, shutil.get_terminal_size().columns)


def say(text: str) -> None:
    """Print a text for people, each line of which is broken between words where it does not fit.

    Parameters
    ----------
    text : lines, of which those of tables have two spaces or more between columns
    """
    width = columns()
    print(text if width is None else fitted(text, width))


def one_line(text: str) -> str:
    """Without the letters, as file names may hold, that would end the line or do something to a terminal."""
    return "".join(letter if letter >= " " and letter not in _CONTROLS else repr(letter)[1:-1] for letter in text)


def fitted(text: str, width: int) -> str:
    """A text, each line of which is broken between words where it does not fit; a word that does not fit is left whole.

    >>> print(fitted("  keeps  walls  each body against six walls", 28))
      keeps  walls
          each body against six
          walls
    >>> print(fitted("  walls  each body against six walls", 34))
      walls  each body against six
             walls
    """
    return "\n".join(part for line in text.split("\n") for part in _broken(line, width))


def _broken(line: str, width: int) -> list[str]:
    if len(line) <= width:
        return [line]
    margin = len(line) - len(line.lstrip())
    ends = [found.end() for found in re.finditer(r"(?<=\S) {2,}(?=\S)", line)]
    start = ends[-1] if ends else margin
    if not ends:
        first, hanging, rest = "", margin + _HANGING, line
    elif width - start >= _LEAST:
        first, hanging, rest = "", start, line
    else:
        first, hanging, rest = line[:start].rstrip(), margin + _HANGING, " " * (margin + _HANGING) + line[start:]
    parts = textwrap.wrap(
        rest, width, subsequent_indent=" " * hanging, break_long_words=False, break_on_hyphens=False
    )  # fmt: skip
    return [*(_broken(first, width) if first else []), *parts]


def _filled(lines: Iterable[str], width: int) -> Iterator[str]:
    """Lines that fit: those of a paragraph are filled, if one of them does not fit, and all others are broken."""
    paragraph: list[str] = []
    for line in [*lines, None]:
        if line and not line.startswith(" "):
            paragraph.append(line)
            continue
        if any(len(one) > width for one in paragraph):
            yield from textwrap.wrap(" ".join(paragraph), width, break_long_words=False, break_on_hyphens=False)
        else:
            yield from paragraph
        paragraph = []
        yield from [] if line is None else _broken(line, width)
