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
OURS = "harness"  # the name of this package where it is installed


class BackendError(InputError):
    """A backend cannot be used; `why` says why, without its name."""

    def __init__(self, name: str, why: str) -> None:
        super().__init__(f'backend "{name}" cannot be used: {why}')
        self.why = why


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
        raise BackendError(name, _why(declared[name], error)) from error
    return backend


def install_command(name: str) -> str | None:
    """What brings the library of a declared backend, where it is an extra."""
    entry = _declared()[name]
    return _command(entry) if _extras(entry) else None


def ours(name: str) -> bool:
    """Whether a declared backend comes with this package."""
    return _ours(_declared()[name])


def is_extra(name: str) -> bool:
    """Whether a backend is declared as an extra of its package."""
    entry = _declared().get(name)
    return entry is not None and bool(_extras(entry))


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
        sys.stdout.flush()
        sys.stderr.flush()
        ctypes.CDLL(None).fflush(None)  # what C has buffered must go before the real output is back
        for stream, copy in kept:
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def _why(entry: EntryPoint, error: ImportError) -> str:
    return f"not installed; {_command(entry)}" if _extras(entry) else f"{type(error).__name__}: {error}"


def _command(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist else OURS
    return f"pip install '{package}[{','.join(_extras(entry))}]'"


def _extras(entry: EntryPoint) -> list[str]:
    try:
        return entry.extras
    except (AttributeError, AssertionError):  # a value that names no module and no class
        return []


def _ours(entry: EntryPoint) -> bool:
    return entry.dist is not None and entry.dist.name == OURS


def _declared() -> dict[str, EntryPoint]:
    return _declared_on(tuple(sys.path))


@lru_cache(maxsize=8)
def _declared_on(path: tuple[str, ...]) -> dict[str, EntryPoint]:
    """Of one `sys.path`: reading the metadata of every package takes milliseconds, which each run would spend.

    A name of ours stays ours, whoever declares it besides.
    """
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=_ours)}
