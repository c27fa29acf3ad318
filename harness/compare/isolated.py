"""A backend in a process of its own, asked pose after pose, so that a crash or a hang costs one answer only."""

from __future__ import annotations

import ctypes
import faulthandler
import multiprocessing
import os
import signal
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from types import TracebackType

import numpy as np

from harness.arrays import Pairs
from harness.backends import registry
from harness.backends.protocol import approximations, own_hulls, own_hulls_tolerance
from harness.compare.poses import Pose
from harness.errors import InputError
from harness.scene.hull import Hull
from harness.scene.scene import Scene

PATIENCE = 10.0
"""s for an answer, by which a backend that hangs is told from a slow one."""
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class Facts:
    """What a loaded backend says of itself for the shape of the scene.

    Parameters
    ----------
    tolerance : of size; nearer contacts are not to be trusted
    approximated : by what it replaces the shape, if it does
    hulls : those it holds in place of the scene's, by the size of a body
    hulls_tolerance : of size, where those are taken as the truth
    """

    tolerance: float
    approximated: str | None = None
    hulls: Mapping[float, Hull] = field(default_factory=dict)
    hulls_tolerance: float = 0.0


class UnusableError(Exception):
    """The backend cannot take the scene at all; says why."""


class Isolated:
    """One backend with one scene. A context: leaving it ends the process.

    Parameters
    ----------
    name : of the backend
    scene : Scene
    patience : s for an answer

    Raises
    ------
    UnusableError
        On entering, if the backend cannot load the scene.
    """

    def __init__(self, name: str, scene: Scene, patience: float = PATIENCE) -> None:
        self._name, self._scene, self._patience = name, scene, patience
        self.shape = scene.shape
        self._process: multiprocessing.process.BaseProcess | None = None

    def __enter__(self) -> Isolated:
        self.facts = self._start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop()

    def pairs(self, pose: Pose) -> Pairs | str:
        """The touching pairs at a pose, or how the backend failed at it; after a failure it is started afresh."""
        if self._process is None:
            self._start()
        try:
            self._channel.send((pose.positions, pose.quaternions))
            if not self._channel.poll(self._patience):
                self._stop()
                return f"no answer within {self._patience:g} s"
            answer: Pairs | str = self._channel.recv()
        except (EOFError, OSError):
            return self._post_mortem()
        return answer

    def _start(self) -> Facts:
        context = multiprocessing.get_context("fork")
        self._channel, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, self._name, self._scene), daemon=True)
        self._process.start()
        theirs.close()
        if not self._channel.poll(10 * self._patience):
            self._stop()
            raise UnusableError("it did not load the scene in time")
        try:
            loaded: Facts | str = self._channel.recv()
        except EOFError:
            raise UnusableError(f"loading the scene, it {self._post_mortem()}") from None
        if isinstance(loaded, str):
            self._stop()
            raise UnusableError(loaded)
        return loaded

    def _stop(self) -> None:
        if self._process is not None:
            self._channel.close()
            self._process.kill()
            self._process.join()
            self._process = None

    def _post_mortem(self) -> str:
        """How a process ended that closed its side without an answer."""
        assert self._process is not None, "it was asked"
        self._process.join(1.0)
        code = self._process.exitcode
        self._stop()
        if code is not None and code < 0:
            return f"ended by signal {-code} ({signal.Signals(-code).name})"
        return f"ended without an answer, exit code {code}"


def _serve(channel: Connection, name: str, scene: Scene) -> None:
    """The process of the backend: load, say what it is, then answer until the other side closes."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    faulthandler.disable()  # it would print the stack of the process that asks
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    try:
        backend = registry.create(name)
        if scene.shape not in backend.shapes:
            raise InputError(f"it has no shape {scene.shape}")
        backend.load(scene)
        facts = Facts(
            float(backend.tolerance(scene.shape)),
            approximations(backend).get(scene.shape),
            own_hulls(backend) if scene.shape == "hull" else {},
            own_hulls_tolerance(backend),
        )
    except Exception as error:  # a plugin may fail in any way
        channel.send(str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}")
        return
    channel.send(facts)
    while True:
        try:
            positions, quaternions = channel.recv()
        except (EOFError, OSError):
            return
        try:
            channel.send(_sound(backend.pairs(positions, quaternions), len(positions)))
        except Exception as error:
            channel.send(f"{type(error).__name__}: {error}")


def _sound(pairs: Pairs, count: int) -> Pairs:
    """The answer, if it is one: pairs i < j of bodies that there are."""
    found = np.asarray(pairs)
    if found.size == 0:
        return np.empty((0, 2), np.int64)
    if found.ndim != 2 or found.shape[1] != 2 or not np.issubdtype(found.dtype, np.integer):
        raise ValueError(f"an answer must be a (k, 2) array of body numbers, not {found.dtype} of shape {found.shape}")
    if (found[:, 0] >= found[:, 1]).any() or found.min() < 0 or found.max() >= count:
        raise ValueError("an answer must have pairs i < j of bodies that there are")
    return found.astype(np.int64)
