"""Backends by name, found by the entry points of the group `harness.backends`.

An entry point may name an extra of its package in brackets, `module:Class [extra]`: the one that brings the library.
"""

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


def create(name: str) -> Backend:
    """A new backend, not loaded yet.

    Parameters
    ----------
    name : as in `engine.backend`

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
            backend: Backend = declared[name].load()()
    except ImportError as error:
        raise InputError(f'backend "{name}" cannot be used: {_why(declared[name], error)}') from error
    return backend


def missing(name: str) -> str | None:
    """Why a backend that is an extra of its package cannot be used, with what to do about it; None if it can.

    Of other backends nothing is said: what they import is looked at where it can do no harm.
    """
    entry = _declared().get(name)
    if entry is None or not entry.extras:
        return None
    try:
        with silence():
            entry.load()
    except ImportError as error:
        return f'backend "{name}" cannot be used: {_why(entry, error)}'
    return None


def install_command(name: str) -> str | None:
    """What brings the library of a declared backend, where it is an extra."""
    entry = _declared()[name]
    return _command(entry) if entry.extras else None


def available() -> dict[str, str | None]:
    """Every declared backend by name, with why it cannot be used, or None if it can."""
    found: dict[str, str | None] = {}
    for name, entry in sorted(_declared().items()):
        try:
            with silence():
                entry.load()
            found[name] = None
        except ImportError as error:
            found[name] = _why(entry, error)
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


def _why(entry: EntryPoint, error: ImportError) -> str:
    return f"not installed; {_command(entry)}" if entry.extras else f"{type(error).__name__}: {error}"


def _command(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist else "harness"
    return f"pip install '{package}[{','.join(entry.extras)}]'"


def _declared() -> dict[str, EntryPoint]:
    return _declared_on(tuple(sys.path))


@lru_cache(maxsize=8)
def _declared_on(path: tuple[str, ...]) -> dict[str, EntryPoint]:
    """Of one `sys.path`: reading the metadata of every package takes milliseconds, which each run would spend."""
    return {entry.name: entry for entry in entry_points(group=GROUP)}
