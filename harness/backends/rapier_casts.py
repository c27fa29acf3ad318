"""Rapier's rotating shape cast, asked in a child process: a cast of two meshes can run without end, or crash.

One cast moves a shape towards another at rest. Of two bodies that both move and turn one is taken for the rest: the
other's motion is told in its axes, where it is no straight line any more, so that a frame is cut into parts in which
the one at rest turns by little.
"""

from __future__ import annotations

import pickle
import warnings
from collections.abc import Iterator
from time import process_time
from typing import NamedTuple

import numpy as np
import rapier3d

from harness.arrays import Pairs
from harness.backends.poses import UniformMotion
from harness.backends.rotations import rotations_at
from harness.child_process import Channel, Child
from harness.cpu_time import charge
from harness.scene.scene import Solid

# s a pair may take; the slowest that ended took 1 s, of 1753 faces
LONGEST = 5.0
# rad that the body at rest turns in a part: the other is then off its path by half the square of it, of the distance
_LARGEST_TURN = 0.02


class Casts:
    """When pairs of a scene's bodies meet. Ends its child when it is ended, or with this process.

    Parameters
    ----------
    shapes : by what bodies share, its vertices (in units) and faces; of a sphere its radius, of a hull no faces
    solids : what each body shares with others, of all n bodies
    unit : m
    longest : s that a pair may take

    Attributes
    ----------
    unanswered : pairs so far whose cast did not end, or ended the child
    """

    def __init__(
        self, shapes: dict[Solid, ShapeData], solids: list[Solid], unit: float, longest: float = LONGEST
    ) -> None:
        self.unanswered = 0
        self._shapes, self._solids, self._unit, self._longest = shapes, solids, unit, longest
        self._child: Child | None = None

    def __del__(self) -> None:
        self._end()

    def impacts(self, pairs: Pairs, motion: UniformMotion) -> list[tuple[int, int, float]]:
        """Which pairs begin to touch, and when, s; one that gives no answer is none."""
        if len(pairs) == 0:
            return []
        found, waiting = [], _questions(pairs, motion, self._solids, self._unit)
        while waiting:
            done = 0
            for answer in self._answers(waiting):
                pair, done = waiting[done].pair, done + 1
                if answer is not None:
                    found.append((*pair, answer))
            if done < len(waiting):
                i, j = waiting[done].pair
                warnings.warn(
                    f"rapier3d gave no answer within {self._longest:g} s on when {i} and {j} meet", stacklevel=2
                )
                self.unanswered += 1
                self._end()
            waiting = waiting[done + 1 :]
        return found

    def _answers(self, questions: list[CastQuestion]) -> Iterator[float | None]:
        """The answers to questions in turn, up to the first that has none."""
        if self._child is None:
            shapes = self._shapes
            self._child = Child.fork(lambda channel: _answer_all(channel, shapes))
        for number in range(len(questions)):
            if number == 0:
                message = self._child.ask(pickle.dumps(questions), self._longest)
            else:
                message = self._child.receive(self._longest)
            if not isinstance(message, bytes):
                charge(self._longest if message == "timeout" else 0.0)
                return
            answer, seconds = pickle.loads(message)
            charge(seconds)
            yield answer

    def _end(self) -> None:
        if self._child is not None:
            self._child.end()
            self._child = None


class ShapeData(NamedTuple):
    """What a shape is made of, in units; a sphere has a radius alone, a hull no faces."""

    radius: float
    vertices: list[list[float]]
    faces: list[list[int]]

    def make(self) -> rapier3d.SharedShape:
        """The shape."""
        if self.faces:
            return rapier3d.SharedShape.trimesh(self.vertices, self.faces)
        if self.vertices:
            return rapier3d.SharedShape.convex_hull(self.vertices)
        return rapier3d.SharedShape.ball(self.radius)


class RelativeMotion(NamedTuple):
    """The motion of one body in the axes of another, from a time on: lengths in units, turn w x y z."""

    start: float
    duration: float
    place: list[float]
    turn: list[float]
    velocity: list[float]
    spin: list[float]


class CastQuestion(NamedTuple):
    """A pair, the solids of the body at rest and of the moving one, and the parts of the motion."""

    pair: tuple[int, int]
    solids: tuple[Solid, Solid]
    parts: list[RelativeMotion]


def _questions(pairs: Pairs, motion: UniformMotion, solids: list[Solid], unit: float) -> list[CastQuestion]:
    """One a pair; the body that spins less is the one at rest."""
    spins = np.linalg.norm(motion.spins, axis=1)
    slower_first = spins[pairs[:, 0]] <= spins[pairs[:, 1]]
    rest, moving = np.where(slower_first[:, None], pairs, pairs[:, ::-1]).T
    counts = np.maximum(1, np.ceil(spins[rest] * motion.duration / _LARGEST_TURN)).astype(np.int64)
    durations = motion.duration / counts
    ends = np.cumsum(counts)
    starts = (np.arange(counts.sum()) - np.repeat(ends - counts, counts)) * np.repeat(durations, counts)
    a, b = np.repeat(rest, counts), np.repeat(moving, counts)
    turns = [rotations_at(motion, bodies, starts) for bodies in (a, b)]
    places = [motion.positions[bodies] + starts[:, None] * motion.velocities[bodies] for bodies in (a, b)]
    back, between = turns[0].inv(), places[1] - places[0]
    velocities = motion.velocities[b] - motion.velocities[a] - np.cross(motion.spins[a], between)
    parts = [
        RelativeMotion(*row)
        for row in zip(
            starts.tolist(),
            np.repeat(durations, counts).tolist(),
            (back.apply(between) / unit).tolist(),
            (back * turns[1]).as_quat()[:, [3, 0, 1, 2]].tolist(),
            (back.apply(velocities) / unit).tolist(),
            back.apply(motion.spins[b] - motion.spins[a]).tolist(),
            strict=True,
        )
    ]
    two_solids = [(solids[i], solids[j]) for i, j in zip(rest.tolist(), moving.tolist(), strict=True)]
    spans = zip((ends - counts).tolist(), ends.tolist(), strict=True)
    told = zip(pairs.tolist(), two_solids, spans, strict=True)
    return [CastQuestion((i, j), of, parts[first:end]) for (i, j), of, (first, end) in told]


def _answer_all(channel: Channel, shapes: dict[Solid, ShapeData]) -> None:
    """What the child does: answers each list of questions by as many messages, until nobody asks any more."""
    made = {solid: shape.make() for solid, shape in shapes.items()}
    worlds = {solid: _world(shape) for solid, shape in made.items()}
    while (message := channel.receive()) is not None:
        for question in pickle.loads(message):
            began = process_time()
            answer = _cast(worlds[question.solids[0]], made[question.solids[1]], question.parts)
            channel.send(pickle.dumps((answer, process_time() - began)))


def _world(shape: rapier3d.SharedShape) -> rapier3d.QueryPipeline:
    """A world with one collider, at rest at the origin."""
    bodies, colliders = rapier3d.RigidBodySet(), rapier3d.ColliderSet()
    colliders.insert(rapier3d.Collider.new(shape))
    pipeline = rapier3d.QueryPipeline(rapier3d.BroadPhaseBvh(), rapier3d.NarrowPhase(), bodies, colliders)
    pipeline.update(bodies, colliders)
    return pipeline


def _cast(world: rapier3d.QueryPipeline, shape: rapier3d.SharedShape, parts: list[RelativeMotion]) -> float | None:
    options = rapier3d.ShapeCastOptions()
    for part in parts:
        motion = rapier3d.NonlinearRigidMotion(
            start=rapier3d.Isometry3(rapier3d.Vec3(*part.place), rapier3d.Rotation3(*part.turn)),
            local_center=[0.0, 0.0, 0.0],
            linvel=rapier3d.Vec3(*part.velocity),
            angvel=rapier3d.Vec3(*part.spin),
        )
        options.max_time_of_impact = part.duration
        hit = world.cast_shape_nonlinear(motion, shape, options, 0.0, part.duration)
        if hit is not None:
            return float(part.start + hit[1].time_of_impact)
    return None
