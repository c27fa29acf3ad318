"""What a backend says of itself: why it cannot be used, or its shapes, tolerances and approximations.

Those of this package are asked here, once for all commands as long as nothing is installed or removed: their libraries
take a second to import. A plugin's is imported in a process of its own, so that one that exits, hangs, prints or
leaves a process behind costs its own line only:

    python -m harness.backends.statement FD NAME
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import lru_cache, partial
from importlib.util import find_spec
from typing import TYPE_CHECKING

from harness.backends import registry
from harness.backends.protocol import approximations, precision, queries, units
from harness.installed import importable
from harness.kept_files import keep, kept
from harness.kernel_cache import PACKAGE
from harness.process_limits import isolate, limit_memory_of_plugin
from harness.vocabulary import Shape

if TYPE_CHECKING:
    from harness.child_process import Channel

# s for the import and the answer of a plugin, of which a person waits for none with the first and for all that
# their plan depends on with the second.
LISTED, NEEDED = 20.0, 120.0


@dataclass(frozen=True)
class Statement:
    """What a backend says.

    Parameters
    ----------
    missing : why it cannot be used, in one line; None if it can, and only then is the rest filled in
    installed : False where it lacks what it imports
    tolerance : of size, by the shapes that it has
    approximations : by what it replaces a shape
    queries : what it can be asked
    lacks : the package that it imports and that is not installed
    """

    missing: str | None
    installed: bool = True
    tolerance: Mapping[str, float] = field(default_factory=dict)
    approximations: Mapping[str, str] = field(default_factory=dict)
    units: str = ""
    precision: str = ""
    queries: tuple[str, ...] = ()
    lacks: str = ""


def statement(name: str, seconds: float = LISTED) -> Statement:
    """Ask a declared backend; whatever it does, it never raises.

    Parameters
    ----------
    name : of a declared backend
    seconds : that a plugin's may take
    """
    return _asked(name, seconds, tuple(sys.path))


def missing(name: str) -> str | None:
    """Why a backend that is an extra of its package cannot be used, with what to do about it; None if it can.

    Of other backends nothing is said: their runs will say it.
    """
    if not registry.is_extra(name):
        return None
    said = statement(name, NEEDED)
    return None if said.installed else f'backend "{name}" cannot be used: {said.missing}'


def approximation(name: str, shape: Shape) -> str | None:
    """By what a backend replaces a shape, if it does.

    Raises
    ------
    BackendError
    """
    if _plugins_asked_here:
        return approximations(registry.create(name)).get(shape)
    said = statement(name, NEEDED)
    if said.missing is not None:
        raise registry.BackendError(name, said.missing)
    return said.approximations.get(shape)


def ask_plugins_here() -> None:
    """Ask plugins in this process from now on, which may end by what they do and costs one run only."""
    global _plugins_asked_here
    _plugins_asked_here = True


_plugins_asked_here = False


@lru_cache(maxsize=32)
def _asked(name: str, seconds: float, path: tuple[str, ...]) -> Statement:
    return _say_once(name, path) if registry.ours(name) else _say_elsewhere(name, seconds)


def _say_once(name: str, path: tuple[str, ...]) -> Statement:
    """What it says, as long as its sources and what can be imported are the same.

    Why it is missing is found out each time, unless it lacks a package that still is not there.
    """
    known = hashlib.sha256(f"{name} {sys.version}".encode())
    for file in sorted((PACKAGE / "backends").glob("*.py")):
        known.update(file.read_bytes())
    known.update(importable(path).encode())
    key = f"{known.hexdigest()[:40]}.json"
    content = kept("statements", key)
    if content is not None and (said := _read(content)) is not None and not (said.lacks and find_spec(said.lacks)):
        return said
    said = _say(name)
    if said.missing is None or (said.lacks and find_spec(said.lacks) is None):
        keep("statements", key, _written(said))
    return said


def _say(name: str) -> Statement:
    """In this process."""
    try:
        backend = registry.create(name)
        with registry.silence():
            return Statement(
                None,
                tolerance={str(shape): float(backend.tolerance(shape)) for shape in backend.shapes},
                approximations={str(shape): str(how) for shape, how in approximations(backend).items()},
                units=units(backend),
                precision=precision(backend),
                queries=tuple(map(str, queries(backend))),
            )
    except registry.BackendError as error:
        lacking = error.__cause__.name if isinstance(error.__cause__, ModuleNotFoundError) else None
        return Statement(_one_line(error.why), installed=False, lacks=(lacking or "").partition(".")[0])
    except MemoryError:
        return Statement("importing it takes more than half of the memory of this machine")
    except (Exception, SystemExit) as error:
        return Statement(_one_line(f"{type(error).__name__}: {error}"))


def _say_elsewhere(name: str, seconds: float) -> Statement:
    from harness.child_process import Child  # where there is no plugin, there is no child

    with Child.spawn("harness.backends.statement", [name], os.environ) as child:
        answer = child.receive(seconds)
        if answer == "timeout":
            return Statement(f"importing it did not end within {seconds:g} s")
        if not isinstance(answer, bytes):
            return Statement(f"importing it ended its process with {child.end()}")
    return _read(answer) or Statement("what it says of itself cannot be read")


def _say_within_limits(name: str, channel: Channel) -> None:
    limit_memory_of_plugin()
    channel.send(_written(_say(name)))


def _read(said: bytes) -> Statement | None:
    """A statement that was written as JSON; None where this is none."""
    try:
        facts = json.loads(said)
        return Statement(**facts | {"queries": tuple(facts["queries"])})
    except (ValueError, TypeError, LookupError):
        return None


def _written(said: Statement) -> bytes:
    """A statement as JSON."""
    return json.dumps(asdict(said)).encode()


def _one_line(text: str) -> str:
    return " ".join(text.split())


if __name__ == "__main__":
    from harness.child_process import Channel, guarded

    isolate()
    guarded(partial(_say_within_limits, sys.argv[2]))(Channel(int(sys.argv[1])))
