"""A stepped method asked at poses that come from elsewhere, in the form of a backend: what a comparison asks."""

from __future__ import annotations

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.errors import InputError
from harness.methods.registry import method_of
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Shape


class AtPoses:
    """The detection of a method, without its motion; the plan is the one of its scene.

    Parameters
    ----------
    name : MethodName

    Raises
    ------
    InputError
        If the method computes events, so that it has no verdict on a pose.
    """

    def __init__(self, name: MethodName) -> None:
        method = method_of(name)
        if not isinstance(method, SteppedMethod):
            raise InputError(f"{name.algorithm} computes events: it has no verdict on a pose")
        self.name = name.pipeline
        self.shapes = method.shapes
        self._method = method
        self._backend = registry.create(name.backend)

    def tolerance(self, shape: Shape) -> float:
        """That of the library which has what the kernels leave; they leave what is nearer than they can prove."""
        return self._backend.tolerance(shape)

    def load(self, scene: Scene) -> None:
        # how far the library is to be trusted may depend on the scene
        self._backend.load(scene)
        self._detector: Detector = self._method.detector(scene, self._method.detection(scene))

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return self._detector.pairs(positions, quaternions)
