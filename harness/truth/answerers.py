"""What can be asked when the bodies of a case begin to touch: the engine, or a backend, which may be stepped."""

from __future__ import annotations

import math
import warnings
from typing import NamedTuple, Protocol, cast

import numpy as np

from harness.backends import registry
from harness.backends.contract import read_only, require_impacts, require_pairs
from harness.backends.protocol import Backend, Impacts, queries
from harness.cpu_time import cpu_time
from harness.errors import InputError
from harness.pair.impact import time_of_impact
from harness.truth.case_scene import CaseScenes, Kind
from harness.truth.families import TOLERANCE
from harness.vocabulary import OWN, MethodName, PipelineName


class Answer(NamedTuple):
    """What was told of a case.

    Attributes
    ----------
    time : s, when the bodies begin to touch; inf if they do not in the window
    seconds : of CPU time that it took
    tolerance : m: the gap up to which it takes bodies for touching, or cannot tell
    """

    time: float
    seconds: float
    tolerance: float


class AskedEngine(NamedTuple):
    """Who is asked.

    Attributes
    ----------
    name : as a person named it
    backend : empty for the engine
    dt : s, from frame to frame, of a backend that is stepped; 0 of one that says when
    """

    name: str
    backend: str
    dt: float

    @property
    def label(self) -> str:
        """Its name, and its step."""
        return f"{self.name} dt {self.dt:.6g}" if self.dt else self.name


class Answerer(Protocol):
    """Answers for the cases of a set, one after the other."""

    def answer(self, row: int) -> Answer | None:
        """What it tells of a case; None where it has no such shape. May raise whatever a library does."""


def asked_engines(names: list[str], steps: list[float]) -> list[AskedEngine]:
    """Who is asked, from what a person named.

    Raises
    ------
    InputError
        If there is no such backend, or it is nothing that can be asked about one pair.
    """
    found = []
    for name in names:
        backend, algorithm = PipelineName.read(name)
        if name == OWN:
            found.append(AskedEngine(name, "", 0.0))
            continue
        if backend not in registry.names():
            raise InputError(f'there is no backend "{name}"; there are {OWN}, {", ".join(registry.names())}')
        if algorithm is not None and PipelineName.read(MethodName.read(name, "mesh").short).algorithm is not None:
            alone = MethodName.read(backend, "mesh")
            raise InputError(
                f"{name}: of one pair there is nothing to leave out; name {OWN} for the engine, {backend} for when the "
                f"library itself says that bodies meet, or {backend}/{alone.algorithm} for its test, frame by frame"
            )
        if algorithm is not None or not _says_when(backend):
            found += [AskedEngine(name, backend, dt) for dt in steps]
        else:
            found.append(AskedEngine(name, backend, 0.0))
    return found


def answerer(engine: AskedEngine, scenes: CaseScenes) -> Answerer:
    """Who answers for an engine.

    Raises
    ------
    InputError
        If its library is missing.
    """
    if not engine.backend:
        return _Engine(scenes)
    registry.create(engine.backend)
    return _Asked(engine, scenes)


def _says_when(name: str) -> bool:
    try:
        return "impact" in queries(registry.create(name))
    except InputError:  # not installed: which its row says
        return True


class _Engine:
    """This program's search, as `harness.time_of_impact` is: at a tolerance of 1e-12 of the mean size."""

    def __init__(self, scenes: CaseScenes) -> None:
        self._scenes, self._ready = scenes, set[str]()

    def answer(self, row: int) -> Answer:
        a, b = self._scenes.bodies(row)
        window = self._scenes.motion(row).duration
        if a.shape not in self._ready:  # kernels are made ready, or loaded, by the first call
            time_of_impact(a, b, 0.0, TOLERANCE)
            self._ready.add(a.shape)
        start = cpu_time()
        time = float(cast(float, time_of_impact(a, b, window, TOLERANCE)))
        seconds = cpu_time() - start
        if math.isnan(time):
            raise ArithmeticError("the engine could not decide")
        return Answer(time, seconds, TOLERANCE * (a.size + b.size) / 2.0)


class _Asked:
    """A backend, loaded once for all cases of a kind that follow each other."""

    def __init__(self, engine: AskedEngine, scenes: CaseScenes) -> None:
        self._asked, self._scenes = engine, scenes
        self._kind: Kind | None = None
        self._backend: Backend | None = None

    def answer(self, row: int) -> Answer | None:
        shape, kind = self._scenes.shape(row), self._scenes.kind(row)
        if kind != self._kind or self._backend is None:
            self._kind, self._backend = kind, registry.create(self._asked.backend)
            if shape not in self._backend.shapes:
                self._kind = None
                return None
            self._backend.load(self._scenes.scene(row))
        tolerance = self._backend.tolerance(shape) * sum(kind.sizes) / 2.0
        told = self._stepped(self._backend, row) if self._asked.dt else self._said(self._backend, row)
        return Answer(*told, tolerance)

    def _said(self, backend: Backend, row: int) -> tuple[float, float]:
        """When the backend says that they meet, and what it took.

        What is to be told are pairs that are apart at the start; whether they touch there, its own test says.
        """
        motion = self._scenes.motion(row)
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            start = cpu_time()
            found = cast(Impacts, backend).impacts(
                read_only(motion.positions),
                read_only(motion.quaternions),
                read_only(motion.velocities),
                read_only(motion.spins),
                motion.duration,
            )
            seconds = cpu_time() - start
        times = require_impacts(backend.name, found, 2, motion.duration).times
        if len(times):
            return float(times[0]), seconds
        if unanswered := [str(warning.message) for warning in warned if warning.category is UserWarning]:
            raise TimeoutError(unanswered[0])  # a backend says so of a pair whose search it has ended
        touching = require_pairs(backend.name, backend.pairs(*map(read_only, motion.at(0.0))), 2)
        return (0.0 if len(touching) else math.inf), seconds

    def _stepped(self, backend: Backend, row: int) -> tuple[float, float]:
        """The first frame that sees them touch, and what all frames up to it took; the last one is the window's end."""
        motion, dt = self._scenes.motion(row), self._asked.dt
        frames = [*(np.arange(math.ceil(motion.duration / dt)) * dt).tolist(), motion.duration]
        seconds = 0.0
        for time in frames:
            poses = [read_only(part) for part in motion.at(time)]
            start = cpu_time()
            found = backend.pairs(poses[0], poses[1])
            seconds += cpu_time() - start
            if len(require_pairs(backend.name, found, 2)):
                return time, seconds
        return math.inf, seconds
