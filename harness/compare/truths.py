"""What is true at one pose, decided once however many methods are held against it."""

from __future__ import annotations

from dataclasses import replace

from harness.compare.certificate import Judgement
from harness.compare.judge import judge, touches
from harness.compare.poses import Pose
from harness.scene.scene import Scene

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
