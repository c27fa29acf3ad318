"""Backends by name: the files of this folder that have one, and the entry points of the group `harness.backends`.

A file of this folder is a backend if it says `BACKEND = Class`; what it says is read, not run, since importing a
library takes time and may fail. It may say `PACKAGE = "name"` too: the package that brings the library. An entry point
may name an extra of its package in brackets, `module:Class [extra]`: the one that brings the library.
"""

from __future__ import annotations

import ast
import ctypes
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, requires
from pathlib import Path
from typing import Any

from harness.backends.protocol import DEFAULT_QUERIES, Backend
from harness.errors import InputError
from harness.vocabulary import Abilities

GROUP = "harness.backends"
PROGRAM = "harness"


class BackendError(InputError):
    """A backend cannot be used; `why` says why, without its name."""

    def __init__(self, name: str, why: str) -> None:
        super().__init__(f'backend "{name}" cannot be used: {why}')
        self.why = why


@dataclass(frozen=True)
class DeclaredBackend:
    """A backend that is declared, installed or not.

    Parameters
    ----------
    load : imports its class
    source : of a file of this folder, its name and that of the class
    command : what brings its library, where that is an extra of its own
    packages : whose versions its verdicts and times depend on
    ours : whether it comes with this program
    """

    load: Callable[[], type[Backend]]
    source: tuple[str, str] | None = None
    command: str | None = None
    packages: frozenset[str] = frozenset()
    ours: bool = True


def names() -> list[str]:
    """The names of all backends that are declared, installed or not, sorted."""
    return sorted(_declared())


def packages() -> frozenset[str]:
    """The packages that a measurement depends on: this program's, and those of every declared backend."""
    return frozenset({PROGRAM}) | _required(PROGRAM).union(*(found.packages for found in _declared().values()))


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
            backend = declared[name].load()()
    except ImportError as error:
        raise BackendError(name, _why(declared[name], error)) from error
    return backend


def abilities_of(name: str) -> Abilities:
    """What a backend can be asked, as its file says; nothing is known of one of another package until it is imported.

    >>> abilities_of("cgal")
    Abilities(shapes=('mesh',), gap_shapes=None, queries=('collision',))
    """
    declared = _declared().get(name)
    return Abilities() if declared is None or declared.source is None else _abilities(*declared.source)


def install_command(name: str) -> str | None:
    """What brings the library of a declared backend, where it is an extra."""
    return _declared()[name].command


def ours(name: str) -> bool:
    """Whether a declared backend comes with this program."""
    return _declared()[name].ours


def is_extra(name: str) -> bool:
    """Whether a backend is declared as an extra of its package."""
    return name in _declared() and _declared()[name].command is not None


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


def _why(declared: DeclaredBackend, error: ImportError) -> str:
    return f"not installed; {declared.command}" if declared.command else f"{type(error).__name__}: {error}"


def _declared() -> dict[str, DeclaredBackend]:
    return _declared_on(tuple(sys.path))


@lru_cache(maxsize=8)
def _declared_on(path: tuple[str, ...]) -> dict[str, DeclaredBackend]:
    """Of one `sys.path`: reading the metadata of every package takes milliseconds, which each run would spend.

    A name of ours stays ours, whoever declares it besides.
    """
    entries = entry_points(group=GROUP)
    # each reading of a name reads all that its package says of itself
    packages = {package: package.name for package in {entry.dist for entry in entries} if package is not None}
    pointed = [(entry.name, _pointed(entry, packages[entry.dist] if entry.dist else "")) for entry in entries]
    theirs = {name: found for name, found in pointed if not found.ours}
    return {**theirs, **_in_this_folder(), **{name: found for name, found in pointed if found.ours}}


def _pointed(entry: EntryPoint, package: str) -> DeclaredBackend:
    extras = _extras(entry)
    command = f"pip install '{package or PROGRAM}[{','.join(extras)}]'" if extras else None
    needed = _required(package, *extras) if package else frozenset[str]()
    ours = package == PROGRAM
    source = _source(entry) if ours else None
    return DeclaredBackend(entry.load, source, command, needed if ours or not package else needed | {package}, ours)


def _source(entry: EntryPoint) -> tuple[str, str] | None:
    folder, _, module = entry.module.rpartition(".")
    return (module, entry.attr) if folder == __package__ else None


def _extras(entry: EntryPoint) -> list[str]:
    try:
        return entry.extras
    except (AttributeError, AssertionError, ValueError):  # a value that names no module and no class
        return []


def _in_this_folder() -> dict[str, DeclaredBackend]:
    """The backends of this folder, each named as its file."""
    found = {}
    for file in sorted(Path(__file__).parent.glob("*.py")):
        said = dict(_constants(file))
        if "BACKEND" in said:
            package = said.get("PACKAGE")
            found[file.stem] = DeclaredBackend(
                _loader(file.stem),
                (file.stem, said["BACKEND"]),
                f"pip install {package}" if package else None,
                frozenset({package} if package else ()),
            )
    return found


def _loader(module: str) -> Callable[[], type[Backend]]:
    def load() -> type[Backend]:
        made: type[Backend] = import_module(f"harness.backends.{module}").BACKEND
        return made

    return load


def _constants(file: Path) -> Iterator[tuple[str, str]]:
    """The names at the top of a file to which a word or another name is assigned, each with that."""
    text = file.read_text(encoding="utf-8")
    for node in ast.parse(text).body if "BACKEND" in text else ():  # else its parsing would be for nothing
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            if isinstance(node.value, ast.Constant):
                yield node.targets[0].id, str(node.value.value)
            elif isinstance(node.value, ast.Name):
                yield node.targets[0].id, node.value.id


@lru_cache(maxsize=32)
def _abilities(module: str, name: str) -> Abilities:
    """What a class of a file of this folder says at its top, read and not run."""
    text = (Path(__file__).parent / f"{module}.py").read_text(encoding="utf-8")
    classes = (node for node in ast.parse(text).body if isinstance(node, ast.ClassDef) and node.name == name)
    made = next(classes, None)
    if made is None:
        return Abilities()
    said = dict(_assigned(made))
    if "queries" not in said and not made.bases:
        said["queries"] = DEFAULT_QUERIES
    return Abilities(**{field: said[field] for field in Abilities._fields if field in said})


def _assigned(made: ast.ClassDef) -> Iterator[tuple[str, Any]]:
    """The attributes of a class to which a literal value is assigned, each with that."""
    for node in made.body:
        if isinstance(node, ast.AnnAssign | ast.Assign) and node.value is not None:
            target: ast.expr = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
            if isinstance(target, ast.Name):
                with suppress(ValueError):
                    yield target.id, ast.literal_eval(node.value)


def _required(package: str, *extras: str) -> frozenset[str]:
    """The packages that a package needs, always or for one of these extras."""
    wanted = [None, *extras]
    return frozenset(name for name, extra in _requirements(package) if extra in wanted)


@lru_cache(maxsize=64)
def _requirements(package: str) -> tuple[tuple[str, str | None], ...]:
    """What a package says that it needs, each with the extra that it is needed for; nothing of one that is missing."""
    try:
        lines = requires(package) or ()
    except PackageNotFoundError:
        return ()
    parts = [(re.match(r"[\w.-]+", line), re.search(r"extra\s*==\s*['\"]([^'\"]+)", line)) for line in lines]
    return tuple((name[0], extra[1] if extra else None) for name, extra in parts if name)
