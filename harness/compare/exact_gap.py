"""The exact gap of two bodies of a scene at a pose, and whether it is at most a length."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from harness.compare.certificate import Certificate
from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import DistanceCertificate, hull_distance, root, surface_distance
from harness.compare.judge import judge
from harness.compare.poses import Pose
from harness.scene.mesh import Surface
from harness.scene.scene import Scene


class ExactGap:
    """How far two bodies are apart.

    Parameters
    ----------
    scene : with the hulls that count
    pose : Pose
    bodies : which two

    Attributes
    ----------
    value : m, rounded once or twice
    """

    def __init__(self, scene: Scene, pose: Pose, bodies: tuple[int, int] = (0, 1)) -> None:
        self._scene, self._pose, self._bodies = scene, pose, bodies
        self._certificate: DistanceCertificate | None = None
        if scene.shape == "sphere":
            judged = judge(scene, *bodies, pose.positions, pose.quaternions)
            self.value, self._of_spheres = max(0.0, judged.gap), judged.certificate
            return
        (first, placed), (second, other) = map(self._placed, bodies)
        if scene.shape == "hull":
            self._certificate = hull_distance(placed, other)
        else:
            self._certificate = surface_distance(placed, first.faces, other, second.faces)
        self.value = self._certificate.gap

    def at_most(self, length: float) -> bool | None:
        """Whether the gap is at most so much, m, exactly; None where the bounds do not decide it."""
        if self._certificate is None:
            chosen = list(self._bodies)
            positions, sizes = self._pose.positions[chosen].tolist(), self._scene.bodies.sizes[chosen].tolist()
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
        (first, placed), (second, other) = map(self._placed, self._bodies)
        if self._scene.shape == "hull":
            whole, other_whole = (np.arange(len(solid.vertices))[None] for solid in (first, second))
            self._certificate.check(placed, whole, other, other_whole)
        else:
            self._certificate.check(placed, first.faces, other, second.faces)

    @property
    def certificate(self) -> Certificate:
        """The proof, in the form that JSON holds: vertices with their weights in the nearest points, and the bounds."""
        if self._certificate is None:
            return self._of_spheres
        proven = self._certificate
        first, second = (
            [[vertex, str(Fraction(weight, sum(part for _, part in side)))] for vertex, weight in side]
            for side in proven.weights
        )
        return {
            "kind": "nearest points and separating planes",
            "first": first,
            "second": second,
            "planes": len(proven.planes),
            "lower": root(proven.lower),
            "upper": root(proven.upper),
        }

    def _placed(self, body: int) -> tuple[Surface, PlacedPoints]:
        solid = self._scene.solid_of_body(body)
        return solid, PlacedPoints(solid.vertices, self._pose.positions[body], self._pose.quaternions[body])
