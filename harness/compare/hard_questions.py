"""Pairs put where verdicts are hard, and what they are asked: at rest, or in a frame that takes them there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from harness.compare.hard_poses import hard_poses
from harness.compare.placing import random_direction
from harness.compare.poses import Frame, Pose, PoseSet
from harness.compare.question import Question
from harness.motion.kinematics import turn
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.vocabulary import Shape

_SEED = 259
# Of a frame that takes bodies to a pose in its middle: sizes that they come nearer, and radians that each turns.
_WAY, _TURN = 0.2, 0.3


def hard_questions(
    shape: Shape, meshes: tuple[Mesh, ...], every: int, question: Question, size: float
) -> Iterator[PoseSet]:
    """The hard poses of a shape, asked a question.

    Parameters
    ----------
    shape, meshes, every : as for `harness.compare.hard_poses.hard_poses`
    question : about bodies of a mean size; of larger ones what is near is as much larger
    size : m, the mean
    """
    for pose_set in hard_poses(shape, meshes, every):
        scaled = question.scaled(float(pose_set.scene.bodies.sizes.mean()) / size)
        poses = partial(_passing, pose_set.poses) if question.query == "impact" else pose_set.poses
        yield replace(pose_set, question=scaled, poses=poses)


def _passing(poses: Callable[[Scene], Sequence[Pose]], scene: Scene) -> tuple[Frame, ...]:
    """A frame of 1 s for each pose, in whose middle the bodies are there: one comes nearer, and both turn."""
    smaller = float(scene.bodies.sizes.min())
    return tuple(_frame(pose, smaller, place) for place, pose in enumerate(poses(scene)))


def _frame(pose: Pose, size: float, place: int) -> Frame:
    rng = np.random.default_rng((_SEED, place))
    apart = pose.positions[0] - pose.positions[1]
    length = float(np.linalg.norm(apart))
    velocities = np.zeros((2, 3))
    velocities[1] = _WAY * size * (apart / length if length else random_direction(rng))
    spins = _TURN * np.array([random_direction(rng), random_direction(rng)])
    quaternions = np.empty((2, 4))
    turn(pose.quaternions, spins, -0.5, quaternions)
    positions = pose.positions - 0.5 * velocities
    return Frame(f"past {pose.name}", positions, quaternions, velocities, spins, 1.0)
