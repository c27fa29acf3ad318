"""Standard streams that a command can rely on: always open, and never the end of it when nobody reads them."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

_STANDARD = (0, 1, 2)


@contextmanager
def reliable_streams() -> Iterator[Reliable]:
    """Standard output and error of this process, made reliable for as long as it lives.

    Yields
    ------
    Reliable
        Standard output.
    """
    _fill_closed()
    sys.stdout.flush()
    sys.stderr.flush()
    output = Reliable(1, sys.stdout, errors="backslashreplace")  # not every terminal knows every letter
    sys.stdout, sys.stderr = output, Reliable(2, sys.stderr, errors="backslashreplace")
    try:
        yield output
    finally:
        sys.stdout.flush()
        sys.stderr.flush()


class Reliable(io.TextIOWrapper):
    """Text into a file descriptor. Once that takes no more, what follows is dropped.

    Attributes
    ----------
    lost : why the descriptor took no more; None while it does
    """

    def __init__(self, descriptor: int, like: TextIO, errors: str) -> None:
        # under PYTHONUNBUFFERED a stream writes through, and not line by line; what lies below this one keeps lines
        line_by_line = bool(like.line_buffering) or getattr(like, "write_through", False)
        super().__init__(
            os.fdopen(descriptor, "wb", closefd=False),
            encoding=like.encoding,
            errors=errors,
            line_buffering=line_by_line,
        )
        self.lost: OSError | None = None

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError as error:
            self._drop(error)
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as error:
            self._drop(error)

    def _drop(self, error: OSError) -> None:
        self.lost = self.lost or error
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())  # children write there, too
        os.close(nowhere)
        super().flush()


def speaks_unicode(stream: TextIO) -> bool:
    """Whether every letter can be written as it is; a stream that keeps text has no encoding."""
    return (stream.encoding or "utf8").lower().replace("-", "").replace("_", "") == "utf8"


def _fill_closed() -> None:
    """Open what was closed before this process began (`>&-`), lest a database or a socket get its number."""
    for descriptor in _STANDARD:
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # it gets the lowest number that is free: this one
            os.set_inheritable(descriptor, True)
    for name, descriptor in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(descriptor, "w", closefd=False))
