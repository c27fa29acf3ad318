"""A backend in a process of its own, asked pose after pose, so that a crash or a hang costs one answer only."""

from __future__ import annotations

import pickle
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from time import process_time
from types import TracebackType
from typing import Any

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.backends.contract import ContractError, read_only, require_pairs
from harness.backends.protocol import (
    Backend,
    approximations,
    contained_is_touching,
    own_hulls,
    own_hulls_tolerance,
)
from harness.child_process import Channel, Child
from harness.compare.poses import Pose
from harness.errors import InputError
from harness.methods.at_poses import AtPoses
from harness.scene.hull import Hull
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Shape

ANSWER_SECONDS = 10.0
"""s for an answer, by which a backend that hangs is told from a slow one."""
# As many times as long for loading the scene.
_LOADING = 10


@dataclass(frozen=True)
class Facts:
    """What a loaded backend declares of itself for the shape of the scene.

    Parameters
    ----------
    tolerance : of size; nearer contacts are not to be trusted
    approximated : by what it replaces the shape, if it does
    hulls : those it holds in place of the scene's, by the size of a body
    hulls_tolerance : of size, where those are taken as the truth
    solid : it says that of two bodies one inside the other touches, though the shape is a surface
    """

    tolerance: float
    approximated: str | None = None
    hulls: Mapping[float, Hull] = field(default_factory=dict)
    hulls_tolerance: float = 0.0
    solid: bool = False


class UnusableError(Exception):
    """The backend cannot take the scene at all, and why."""


class HangingError(UnusableError):
    """It did not take the scene in the time that it has, as it would any other, as far as one can tell."""


class Isolated:
    """What is compared under one name, with one scene. A context: leaving it ends the process.

    Parameters
    ----------
    name : of what answers; `_create` makes of it what is asked, and nothing else looks into it
    scene : Scene
    timeout : s for an answer

    Attributes
    ----------
    facts : what it declares of itself, once entered

    Raises
    ------
    UnusableError
        On entering, if it cannot load the scene.
    """

    def __init__(self, name: str, scene: Scene, timeout: float = ANSWER_SECONDS) -> None:
        self._name, self._scene, self._timeout = name, scene, timeout
        self._child: Child | None = None

    def __enter__(self) -> Isolated:
        self.facts = self._start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def pairs(self, pose: Pose) -> Pairs | str:
        """The touching pairs at a pose, or how the backend failed at it; after a failure it is started afresh."""
        if self._child is None:
            try:
                self._start()
            except UnusableError as error:
                return str(error)
        assert self._child is not None, "it has been started"
        answer = self._child.ask(pickle.dumps((pose.positions, pose.quaternions)), self._timeout)
        if isinstance(answer, bytes):
            found: Pairs | str = pickle.loads(answer)
            return found
        ending, self._child = self._child.end(), None
        return f"no answer within {self._timeout:g} s" if answer == "timeout" else ending.instead_of("an answer")

    def seconds_a_query(self, poses: Sequence[Pose]) -> float | None:
        """CPU time of a query when these poses, all of them answered before, are asked one right after another, s."""
        if self._child is None or not poses:
            return None
        asked = _Timed(tuple((pose.positions, pose.quaternions) for pose in poses))
        answer = self._child.ask(pickle.dumps(asked), self._timeout * len(poses))
        if isinstance(answer, bytes):
            seconds: float | None = pickle.loads(answer)
            return seconds
        self._end()
        return None

    def _start(self) -> Facts:
        self._child = Child.fork(partial(_serve, self._name, self._scene))
        try:
            answer = self._child.receive(_LOADING * self._timeout)
            if answer == "timeout":
                raise HangingError(
                    f"it did not load the scene within {_LOADING * self._timeout:g} s, and is not asked again"
                )
            if not isinstance(answer, bytes):
                raise UnusableError(f"loading the scene, it {self._child.end().instead_of('an answer')}")
            loaded: Facts | str = pickle.loads(answer)
            if isinstance(loaded, str):
                raise UnusableError(loaded)
        except BaseException:
            self._end()
            raise
        return loaded

    def _end(self) -> None:
        if self._child is not None:
            self._child.end()
            self._child = None


def preload(name: str) -> None:
    """Import what stands behind a name, where it comes with this program: then the processes of it need not, each."""
    backend = name.partition("/")[0]
    if registry.ours(backend):
        with suppress(InputError):
            registry.create(backend)


def _create(name: str, shape: Shape) -> Backend:
    """What stands behind a name: a method of this program ("fcl/grid"), or a backend's own pipeline ("pybullet")."""
    return AtPoses(MethodName.read(name, shape)) if "/" in name else registry.create(name)


def _serve(name: str, scene: Scene, channel: Channel) -> None:
    """The process of the backend: load, send the facts, then answer until the parent closes its end."""
    try:
        backend = _create(name, scene.shape)
        if scene.shape not in backend.shapes:
            raise InputError(f"it has no shape {scene.shape}")
        backend.load(scene)
        facts = Facts(
            float(backend.tolerance(scene.shape)),
            approximations(backend).get(scene.shape),
            own_hulls(backend) if scene.shape == "hull" else {},
            own_hulls_tolerance(backend),
            contained_is_touching(backend, scene.shape),
        )
    except Exception as error:  # a plugin may fail in any way
        channel.send(pickle.dumps(str(error) if isinstance(error, InputError) else _told(error)))
        return
    channel.send(pickle.dumps(facts))
    # what is our own needs no read-only view, for which its kernels would be compiled anew
    guarded = (lambda poses: poses) if isinstance(backend, AtPoses) else read_only
    while (asked := channel.receive()) is not None:
        question = pickle.loads(asked)
        answer: Any
        try:
            if isinstance(question, _Timed):
                answer = question.seconds(backend)
            else:
                positions, quaternions = question
                answer = backend.pairs(guarded(positions), guarded(quaternions))
                answer = require_pairs(name, answer, len(positions))
        except ContractError as error:
            answer = str(error)
        except Exception as error:
            answer = None if isinstance(question, _Timed) else _told(error)
        channel.send(pickle.dumps(answer))


@dataclass(frozen=True, eq=False)
class _Timed:
    """Poses to be asked about without a pause: positions and quaternions of each."""

    poses: tuple[tuple[Floats, Floats], ...]

    def seconds(self, backend: Backend) -> float:
        """CPU time of a query."""
        started = process_time()
        for positions, quaternions in self.poses:
            backend.pairs(positions, quaternions)
        return (process_time() - started) / len(self.poses)


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
