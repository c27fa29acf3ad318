"""What is true at one pose, decided once however many methods are held against it."""

from __future__ import annotations

from dataclasses import replace

from harness.compare.certificate import Judgement
from harness.compare.exact_gap import ExactGap
from harness.compare.judge import judge, touches
from harness.compare.poses import Frame, Pose
from harness.scene.scene import Scene
from harness.vocabulary import Shape

Pair = tuple[int, int]


class Truths:
    """The judge's verdicts on the pairs of one pose, each worked out when it is first asked for.

    Parameters
    ----------
    scene : with the hulls that the methods are held against
    pose : Pose
    """

    def __init__(self, scene: Scene, pose: Pose) -> None:
        self.pose = pose
        self._scene = scene
        self._judged: dict[Pair, Judgement] = {}
        self._of_hulls: dict[Pair, Judgement] = {}
        self._touching: dict[Pair, bool] = {}
        self._gaps: dict[tuple[Pair, Shape], ExactGap] = {}
        self._later: dict[float, Truths] = {}

    def judgement(self, pair: Pair) -> Judgement:
        """Whether they touch, with gap and proof."""
        if pair not in self._judged:
            self._judged[pair] = judge(self._scene, *pair, self.pose.positions, self.pose.quaternions)
        return self._judged[pair]

    def of_hulls(self, pair: Pair) -> Judgement:
        """The same of their hulls, where the shape is a mesh."""
        if pair not in self._of_hulls:
            hulls = replace(self._scene, shape="hull")
            self._of_hulls[pair] = judge(hulls, *pair, self.pose.positions, self.pose.quaternions)
        return self._of_hulls[pair]

    def touch(self, pair: Pair) -> bool:
        """Whether they touch."""
        if pair not in self._touching:
            judged = self._judged.get(pair)
            self._touching[pair] = (
                judged.touching
                if judged is not None
                else touches(self._scene, *pair, self.pose.positions, self.pose.quaternions)
            )
        return self._touching[pair]

    def gap(self, pair: Pair, shape: Shape) -> ExactGap:
        """How far they are apart, of a shape: that of the scene, or their hulls in place of meshes."""
        if (pair, shape) not in self._gaps:
            self._gaps[pair, shape] = ExactGap(replace(self._scene, shape=shape), self.pose, pair)
        return self._gaps[pair, shape]

    def later(self, seconds: float) -> Truths:
        """What is true so many seconds after the start of the frame that the pose is."""
        if seconds not in self._later:
            assert isinstance(self.pose, Frame), "bodies move in frames only"
            self._later[seconds] = Truths(self._scene, self.pose.at(self._scene, seconds))
        return self._later[seconds]
