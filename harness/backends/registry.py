"""Backends by name, found by the entry points of the group `harness.backends`."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points

from harness.backends.protocol import Backend
from harness.errors import InputError

GROUP = "harness.backends"


def names() -> list[str]:
    """The names of all backends that are declared, installed or not, sorted."""
    return sorted(_declared())


def create(name: str, algorithm: str = "native") -> Backend:
    """A new backend, not loaded yet.

    Parameters
    ----------
    name : as in `engine.backend`
    algorithm : given to the backend, unless it is its own (`native`)

    Raises
    ------
    InputError
        If there is none of this name, or its library is missing.
    """
    declared = _declared()
    if name not in declared:
        raise InputError(f'there is no backend "{name}"; there are {", ".join(sorted(declared))}')
    try:
        with silence():
            made = declared[name].load()
            backend: Backend = made() if algorithm == "native" else made(algorithm)
    except ImportError as error:
        raise InputError(f'backend "{name}" cannot be used: {error}') from error
    return backend


def available() -> dict[str, str | None]:
    """Every declared backend by name, with why it cannot be used, or None if it can."""
    found: dict[str, str | None] = {}
    for name, entry in sorted(_declared().items()):
        try:
            with silence():
                entry.load()
            found[name] = None
        except Exception as error:  # a plugin may fail in any way; it must not take the others with it
            found[name] = f"{type(error).__name__}: {error}"
    return found


@contextmanager
def silence() -> Iterator[None]:
    """Drop what native libraries print (pybullet greets on import): standard output is for results alone."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [(stream, os.dup(stream)) for stream in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream, _ in kept:
        os.dup2(nowhere, stream)
    try:
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # what C has buffered must go before the real output is back
        for stream, copy in kept:
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def _declared() -> dict[str, EntryPoint]:
    return _declared_on(tuple(sys.path))


@lru_cache(maxsize=8)
def _declared_on(path: tuple[str, ...]) -> dict[str, EntryPoint]:
    """Of one `sys.path`: reading the metadata of every package takes milliseconds, which each run would spend."""
    return {entry.name: entry for entry in entry_points(group=GROUP)}
