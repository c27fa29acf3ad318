"""What a method tells of each pair when it is asked a query other than collision, at given poses or in given frames."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TypeAlias

from harness.backends.protocol import Backend, NearPairs, approximations
from harness.compare.poses import Frame, Pose
from harness.compare.question import Question
from harness.compare.witnesses import misplaced
from harness.methods.at_poses import QueryAtPoses
from harness.methods.impact_times import FrameMotion
from harness.methods.registry import method_of
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Shape

PairAnswers: TypeAlias = dict[tuple[int, int], float]
"""By pair i < j: the gap, m, of "distance"; s after the start of the frame, of "impact"; 0 where no number is asked."""


@cache
def make_ready(name: MethodName) -> None:
    """Compile the kernels of a method here, so that no process forked from this one has to before it answers."""
    if name.kernels:
        for _, compile_kernels in method_of(name, within=0.0).warm_ups():
            compile_kernels()


class QueryAnswers:
    """A method in the process that asks it.

    Parameters
    ----------
    name : MethodName, of the query
    question : how the query is set

    Attributes
    ----------
    misplaced : at the last pose, a pair whose nearest points are none, and what is wrong with them
    """

    misplaced: tuple[tuple[int, int], str] | None = None

    def __init__(self, name: MethodName, question: Question) -> None:
        self._name, self._asked = name, QueryAtPoses(name, question.tolerance, question.within)
        self.shapes = self._asked.shapes
        self._last = 0

    @property
    def library(self) -> Backend | None:
        """The backend that answers; None where kernels of this program do."""
        return None if self._name.kernels else self._asked.backend

    def tolerance(self, shape: Shape) -> float:
        """Of size, by how much it may be off as is declared."""
        return self._asked.tolerance(shape)

    def asked_for(self, shape: Shape) -> float:
        """Of size, by how much it may be off because no more was asked for."""
        return self._asked.asked_for(shape)

    def load(self, scene: Scene) -> None:
        """Hold a scene."""
        self._asked.load(scene)
        self._scene = scene

    def answers_at(self, pose: Pose) -> PairAnswers:
        """What it tells of every pair that it reports."""
        if isinstance(pose, Frame):
            motion, self._last = self._motion(pose), 0
            pairs, values = self._asked.impacts(motion, pose.duration)
            self._last = pose.number  # not of a frame that failed: nothing can go on from there
        else:
            found = self._asked.near(pose.positions, pose.quaternions)
            self.misplaced = self._misplaced(pose, found)
            pairs, values, _ = found
        numbers = [0.0] * len(pairs) if self._name.query == "tolerance" else values.tolist()
        return {(i, j): number for (i, j), number in zip(pairs.tolist(), numbers, strict=True)}

    def _misplaced(self, pose: Pose, found: NearPairs) -> tuple[tuple[int, int], str] | None:
        """Of a library; points of our kernels are certified where they are made."""
        if self.library is None or self._name.query != "distance":
            return None
        replaced = approximations(self.library).get(self._scene.shape) is not None
        off = misplaced(replace(self._scene, shape="hull") if replaced else self._scene, pose, found)
        if off is None:
            return None
        (i, j), length = off
        return (i, j), (
            f"its nearest points of bodies {i} and {j} are {length:.3g} m off the bodies, or are by as much not as far "
            "apart as it says"
        )

    def _motion(self, frame: Frame) -> FrameMotion:
        follows = 0 < self._last == frame.number - 1
        middle = frame.at(self._scene, 0.5 * frame.duration).positions
        motion = frame.velocities, frame.spins
        return FrameMotion(frame.positions, frame.quaternions, middle, *motion, not follows, frame.duration)
