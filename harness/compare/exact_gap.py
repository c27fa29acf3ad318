"""The exact gap of the two bodies of a scene at a pose, and whether it is at most a length."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from harness.compare.exact import Placed
from harness.compare.exact_distance import DistanceCertificate, hull_distance, root, surface_distance
from harness.compare.judge import judge
from harness.compare.poses import Pose
from harness.scene.mesh import Surface
from harness.scene.scene import Scene


class ExactGap:
    """How far two bodies are apart.

    Parameters
    ----------
    scene : of two bodies, with the hulls that count
    pose : Pose

    Attributes
    ----------
    value : m, rounded once or twice
    """

    def __init__(self, scene: Scene, pose: Pose) -> None:
        self._scene, self._pose = scene, pose
        self._certificate: DistanceCertificate | None = None
        if scene.shape == "sphere":
            self.value = max(0.0, judge(scene, 0, 1, pose.positions, pose.quaternions).gap)
            return
        (first, placed), (second, other) = self._placed(0), self._placed(1)
        if scene.shape == "hull":
            self._certificate = hull_distance(placed, other)
        else:
            self._certificate = surface_distance(placed, first.faces, other, second.faces)
        self.value = self._certificate.gap

    def at_most(self, length: float) -> bool | None:
        """Whether the gap is at most so much, m, exactly; None where the bounds do not decide it."""
        if self._certificate is None:
            positions, sizes = self._pose.positions.tolist(), self._scene.bodies.sizes.tolist()
            squared = sum(((Fraction(b) - Fraction(a)) ** 2 for a, b in zip(*positions, strict=True)), Fraction(0))
            reach = (Fraction(sizes[0]) + Fraction(sizes[1])) / 2 + Fraction(length)
            return squared <= reach * reach
        limit = Fraction(length) ** 2
        if self._certificate.upper <= limit:
            return True
        return False if self._certificate.lower > limit else None

    def off_by(self, told: float) -> float:
        """m, by how much a gap that was told lies outside of the certified bounds."""
        if self._certificate is None:
            return abs(told - self.value)
        return max(told - self.value, root(self._certificate.lower) - told, 0.0)

    def check(self) -> None:
        """Prove the bounds anew from the bodies alone; of spheres there is nothing to prove but the sum itself.

        Raises
        ------
        ArithmeticError
        """
        if self._certificate is None:
            return
        (first, placed), (second, other) = self._placed(0), self._placed(1)
        if self._scene.shape == "hull":
            whole, other_whole = (np.arange(len(solid.vertices))[None] for solid in (first, second))
            self._certificate.check(placed, whole, other, other_whole)
        else:
            self._certificate.check(placed, first.faces, other, second.faces)

    def _placed(self, body: int) -> tuple[Surface, Placed]:
        solid = self._scene.solid_of_body(body)
        return solid, Placed(solid.vertices, self._pose.positions[body], self._pose.quaternions[body])
