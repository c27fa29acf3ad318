"""A backend in a process of its own, asked pose after pose, so that a crash or a hang costs one answer only."""

from __future__ import annotations

import pickle
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from math import inf
from time import process_time
from types import TracebackType
from typing import Any, TypeGuard, cast

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.backends.contract import ContractError, read_only, require_gaps, require_pairs
from harness.backends.protocol import (
    Backend,
    Distances,
    Near,
    approximations,
    contained_is_touching,
    own_hulls,
    own_hulls_tolerance,
    queries,
)
from harness.child_process import Channel, Child, guarded
from harness.compare.own_gaps import OwnGaps
from harness.compare.poses import Frame, Pose
from harness.compare.query_answers import PairAnswers, QueryAnswers
from harness.compare.question import COLLISION, Question
from harness.errors import InputError
from harness.methods.at_poses import AtPoses
from harness.process_limits import limit_memory_of_plugin
from harness.scene.hull import Hull, hull_of
from harness.scene.ignored_pairs import without
from harness.scene.scene import Scene, Solid
from harness.vocabulary import OWN, MethodName, PipelineName, Query, Shape

Pair = tuple[int, int]

LARGEST_TOLERANCE = 1e-3
"""Of a size: a backend that claims more cannot be held to anything, which is a finding of its own."""

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
    hulls : those it holds in place of the scene's, by what bodies share
    hulls_tolerance : of size, where those are taken as the truth
    asked_for : of size; the accuracy that was asked of it, which it need not exceed
    solid : it says that of two bodies one inside the other touches, though the shape is a surface
    queries : what it can be asked
    """

    tolerance: float
    approximated: str | None = None
    hulls: Mapping[Solid, Hull] = field(default_factory=dict)
    hulls_tolerance: float = 0.0
    asked_for: float = 0.0
    solid: bool = False
    queries: tuple[Query, ...] = ("collision",)

    @property
    def allowed(self) -> float:
        """Of size, by how much it may be off: as was asked, or as it declares, though no more than it may declare."""
        return max(self.asked_for, min(self.tolerance, LARGEST_TOLERANCE))

    @property
    def allowed_on_own_hulls(self) -> float:
        """The same, where its hulls are taken as the truth."""
        return max(self.asked_for, min(self.hulls_tolerance, LARGEST_TOLERANCE))


@dataclass(frozen=True, eq=False)
class NearQuestion:
    """How far apart two bodies are, or whether they are near.

    Parameters
    ----------
    query : "distance" or "tolerance"
    pose : Pose
    within : m
    """

    query: Query
    pose: Pose
    within: float

    def ask(self, backend: Backend, positions: Floats, quaternions: Floats) -> object:
        """What the backend says, as it says it."""
        if self._decides(backend):
            return backend.near(positions, quaternions, self.within)
        return cast(Distances, backend).distances(positions, quaternions, self.within)

    def gap(self, name: str, backend: Backend, answer: object, count: int) -> float:
        """m, that the answer tells; of near pairs 0, and inf where they are not."""
        if self._decides(backend):
            return 0.0 if len(require_pairs(name, answer, count)) else inf
        found = require_gaps(name, answer, count, self.within)
        if not len(found.pairs):
            return inf
        return float(found.gaps[0]) if self.query == "distance" else 0.0

    def _decides(self, backend: Backend) -> TypeGuard[Near]:
        """Whether its library decides what is near for less than a distance."""
        return self.query == "tolerance" and isinstance(backend, Near)


class UnusableError(Exception):
    """The backend cannot take the scene at all, and why."""


class BrokenError(UnusableError):
    """It failed over a scene that it should have taken or refused: it crashed, hung, raised or cannot be imported."""


class HangingError(BrokenError):
    """It did not take the scene in the time that it has, as it would any other, as far as one can tell."""


class Isolated:
    """What is compared under one name, with one scene. A context: leaving it ends the process.

    Parameters
    ----------
    name : of what answers; `_create` makes of it what is asked, and nothing else looks into it
    scene : Scene
    timeout : s for an answer
    question : what it is asked at every pose

    Attributes
    ----------
    name, question : as given
    facts : what it declares of itself, once entered
    timeouts : how often it has not answered in time
    misplaced : at the last pose, a pair whose nearest points are none, and what is wrong with them

    Raises
    ------
    UnusableError
        On entering, if it cannot load the scene.
    """

    def __init__(
        self, name: str, scene: Scene, timeout: float = ANSWER_SECONDS, question: Question = COLLISION
    ) -> None:
        self.name, self.question = name, question
        self._scene, self._timeout = scene, timeout
        self.timeouts = 0
        self.misplaced: tuple[Pair, str] | None = None
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
        found: Pairs | str = self._answer((pose.positions, pose.quaternions))
        return found if isinstance(found, str) else without(found, self._scene.ignored)

    def answers_at(self, pose: Pose) -> PairAnswers | str:
        """What it tells of each pair at a pose, or in a frame, or how it failed there, as `pairs`.

        A frame goes on where the last one ended, if it is the next. Of collision the number is 0.
        """
        if self.question.query == "collision":
            found = self.pairs(pose)
            return found if isinstance(found, str) else dict.fromkeys(map(tuple, found.tolist()), 0.0)
        reply: tuple[PairAnswers | str, tuple[Pair, str] | None] | str = self._answer(pose)
        if isinstance(reply, str):
            return reply
        answer, self.misplaced = reply
        return answer

    def near(self, question: NearQuestion) -> float | str:
        """The gap that it tells of a pair, m; 0 where it says that they are near, and inf that they are not."""
        found: float | str = self._answer(question)
        return found

    def _answer(self, question: Any) -> Any:
        if self._child is None:
            try:
                self._start()
            except UnusableError as error:
                return str(error)
        assert self._child is not None, "it has been started"
        answer = self._child.ask(pickle.dumps(question), self._timeout)
        if isinstance(answer, bytes):
            return pickle.loads(answer)
        ending, self._child = self._child.end(), None
        self.timeouts += answer == "timeout"
        return f"no answer within {self._timeout:g} s" if answer == "timeout" else ending.instead_of("an answer")

    def seconds_a_query(self, poses: Sequence[Pose], near: NearQuestion | None = None) -> float | None:
        """CPU time of a query when these poses, all of them answered before, are asked one right after another, s.

        Of collisions, or of what is asked of gaps, whatever the pose of that question is.
        """
        if self._child is None or not poses:
            return None
        asked = _Timed(tuple((pose.positions, pose.quaternions) for pose in poses), near)
        answer = self._child.ask(pickle.dumps(asked), self._timeout * len(poses))
        if isinstance(answer, bytes):
            seconds: float | None = pickle.loads(answer)
            return seconds
        self._end()
        return None

    def _start(self) -> Facts:
        self._child = Child.fork(guarded(partial(_serve, self.name, self._scene, self.question)))
        try:
            answer = self._child.receive(_LOADING * self._timeout)
            if answer == "timeout":
                raise HangingError(
                    f"it did not load the scene within {_LOADING * self._timeout:g} s, and is not asked again"
                )
            if not isinstance(answer, bytes):
                raise BrokenError(f"loading the scene, it {self._child.end().instead_of('an answer')}")
            loaded: Facts | _Refusal = pickle.loads(answer)
            if isinstance(loaded, _Refusal):
                raise (BrokenError if loaded.broken else UnusableError)(loaded.why)
        except BaseException:
            self._end()
            raise
        return loaded

    def _end(self) -> None:
        if self._child is not None:
            self._child.end()
            self._child = None


@dataclass(frozen=True)
class _Refusal:
    """Why there are no facts, and whether that is a failure of the backend: else it says what it is not made for."""

    why: str
    broken: bool


def preload(name: str) -> None:
    """Import what stands behind a name, where it comes with this program: then the processes of it need not, each."""
    backend = PipelineName.read(name).backend
    if backend != OWN and registry.ours(backend):
        with suppress(InputError):
            registry.create(backend)


def _create(name: str, shape: Shape, question: Question) -> Backend | QueryAnswers:
    """What stands behind a name: a method of this program ("fcl/grid"), or a backend's own pipeline ("pybullet")."""
    if name == OWN:
        return OwnGaps()
    if question.query != "collision":
        return QueryAnswers(MethodName.read(name, shape, question.query), question)
    alone = PipelineName.read(name).algorithm is None
    return registry.create(name) if alone else AtPoses(MethodName.read(name, shape))


def _serve(name: str, scene: Scene, asked: Question, channel: Channel) -> None:
    """The process of the backend: load, send the facts, then answer until the parent closes its end."""
    limit_memory_of_plugin()
    try:
        made = _create(name, scene.shape, asked)
        if scene.shape not in made.shapes:
            raise InputError(f"it has no shape {scene.shape}")
        made.load(scene)
        facts = _facts(made, scene)
    except Exception as error:  # a plugin may fail in any way
        broken = not isinstance(error, InputError) or isinstance(error, registry.BackendError)
        why = str(error) if isinstance(error, InputError | ContractError) else _described(error)
        channel.send(pickle.dumps(_Refusal(why, broken)))
        return
    channel.send(pickle.dumps(facts))
    if isinstance(made, QueryAnswers):
        _answer_queries(made, channel)
    else:
        _answer_all(name, made, channel)


def _facts(made: Backend | QueryAnswers, scene: Scene) -> Facts:
    tolerance = _tolerance(made, scene.shape)
    if not isinstance(made, QueryAnswers):
        backend = made
    elif made.library is None:
        return Facts(tolerance, asked_for=made.asked_for(scene.shape))
    else:
        backend = made.library
    return Facts(
        tolerance,
        approximations(backend).get(scene.shape),
        # in arrays of our own, so that what is none fails here
        {solid: hull_of(hull.vertices, hull.faces) for solid, hull in own_hulls(backend).items()}
        if scene.shape == "hull"
        else {},
        own_hulls_tolerance(backend),
        made.asked_for(scene.shape) if isinstance(made, QueryAnswers) else 0.0,
        contained_is_touching(backend, scene.shape),
        queries(backend),
    )


def _tolerance(made: Backend | QueryAnswers, shape: Shape) -> float:
    """What it declares, if it declares the same however often it is asked."""
    told = [float(made.tolerance(shape)) for _ in range(_TIMES_ASKED)]
    if min(told) < max(told):
        raise ContractError(
            f"it declares a tolerance of {min(told):g} one time and of {max(told):g} another, of the same shape"
        )
    return told[0]


# How often a tolerance is asked for: one that is drawn from two by lot is found out fifteen times in sixteen.
_TIMES_ASKED = 5


def _answer_queries(answers: QueryAnswers, channel: Channel) -> None:
    while (asked := channel.receive()) is not None:
        pose: Pose | Frame = pickle.loads(asked)
        answer: PairAnswers | str
        try:
            answer = answers.answers_at(pose)
        except ContractError as error:
            answer = str(error)
        except Exception as error:
            answer = _described(error)
        channel.send(pickle.dumps((answer, answers.misplaced)))


def _answer_all(name: str, backend: Backend, channel: Channel) -> None:
    # what is our own needs no read-only view, for which its kernels would be compiled anew
    guarded = (lambda poses: poses) if isinstance(backend, AtPoses | OwnGaps) else read_only
    while (asked := channel.receive()) is not None:
        question = pickle.loads(asked)
        answer: Any
        try:
            if isinstance(question, _Timed):
                answer = question.seconds(backend)
            elif isinstance(question, NearQuestion):
                poses = guarded(question.pose.positions), guarded(question.pose.quaternions)
                answer = question.gap(name, backend, question.ask(backend, *poses), len(poses[0]))
            else:
                positions, quaternions = question
                answer = backend.pairs(guarded(positions), guarded(quaternions))
                answer = require_pairs(name, answer, len(positions))
        except ContractError as error:
            answer = str(error)
        except Exception as error:
            answer = None if isinstance(question, _Timed) else _described(error)
        channel.send(pickle.dumps(answer))


@dataclass(frozen=True, eq=False)
class _Timed:
    """Poses to be asked about without a pause: positions and quaternions of each."""

    poses: tuple[tuple[Floats, Floats], ...]
    near: NearQuestion | None = None

    def seconds(self, backend: Backend) -> float:
        """CPU time of a query."""
        ask = backend.pairs if self.near is None else partial(self.near.ask, backend)
        started = process_time()
        for positions, quaternions in self.poses:
            ask(positions, quaternions)
        return (process_time() - started) / len(self.poses)


def _described(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
