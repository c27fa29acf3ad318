"""Compile the kernels of a sweep before it begins, on every core: runs, which are timed, are done one at a time.

A server would compile them too, but when a run first needs them, and then the other cores have nothing to do.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Callable, Iterable
from contextlib import suppress

from harness import kept_files
from harness.backends.registry import ours
from harness.experiment.experiment import Point
from harness.installed import sources_hash, version_of
from harness.runner.point import is_stepped
from harness.runner.warm_up import warm_ups
from harness.vocabulary import Shape
from harness.workers import shared_out, usable_cores

_KIND = "compiled"
_ORDER: tuple[Shape, ...] = ("mesh", "hull", "sphere")
"""Of two shapes, the one whose kernels take longer comes first."""


def compile_ahead(points: Iterable[Point]) -> None:
    """Compile what these points call and was not compiled on this machine, where several cores can share it out.

    What is not compiled here, for whatever reason, the server of a run compiles.

    Parameters
    ----------
    points : of the runs to do; those of a backend that is not ours are passed over
    """
    cold: dict[str, Callable[[], None]] = {}
    # event loops take longest, and what takes longest is begun first
    for point in sorted(points, key=lambda point: (is_stepped(point), _ORDER.index(point.scene.shape))):
        if ours(point.engine.backend):
            for name, compile_it in warm_ups(point):
                cold.setdefault(name, compile_it)
    marks = {name: _mark(name) for name in cold}
    for name, mark in marks.items():
        if kept_files.kept(_KIND, mark) is not None:
            del cold[name]
    if usable_cores() < 2 or len(cold) < 2:
        return
    names = list(cold)
    with suppress(RuntimeError):  # a process has ended
        for place, whole in shared_out([_task(cold[name]) for name in names], usable_cores()):
            if whole:
                kept_files.keep(_KIND, marks[names[place]], b"")


def _task(compile_it: Callable[[], None]) -> Callable[[], bool]:
    """Whether it was compiled."""

    def compiled() -> bool:
        with suppress(Exception):  # a library may be missing, or the memory be too small
            compile_it()
            return True
        return False

    return compiled


def _mark(name: str) -> str:
    """The name of the empty file that says that kernels were compiled: from these sources, by this numba, here."""
    compiler, python = str(version_of("numba")), platform.python_version()
    parts = (name, sources_hash(), compiler, python, platform.machine(), platform.node())
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
