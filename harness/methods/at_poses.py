"""A stepped method asked at poses, or in frames, that come from elsewhere: what a comparison asks."""

from __future__ import annotations

from typing import cast

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.backends.protocol import Distances, Impacts, ImpactTimes, NearPairs, queries, set_accuracy
from harness.errors import InputError
from harness.methods.impact_times import FrameMotion, ImpactFinder, half_moves
from harness.methods.method import Method
from harness.methods.native_queries import NativeImpacts, NativeNearPairs
from harness.methods.near_pairs import NearFinder
from harness.methods.registry import method_of
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Shape

# Of a size: many times what the kernels round a gap by, which they prove from both sides.
_ROUNDING = 1e-13


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
        method = _stepped(method_of(name))
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


class QueryAtPoses:
    """The answers of a method to a query other than collision, without its motion.

    Parameters
    ----------
    name : MethodName
    tolerance : of size, of gaps or of the gap at a time of impact
    within : m, for the queries that need it

    Attributes
    ----------
    backend : its library, which says what it can hold; loaded, and asked, where the pairs are not found by kernels

    Raises
    ------
    InputError
        If the method computes events, or its library is missing, or that has no such query.
    """

    def __init__(self, name: MethodName, tolerance: float, within: float) -> None:
        self._method = _stepped(method_of(name, tolerance=tolerance, within=within))
        self._name, self._tolerance, self._within = name, tolerance, within
        self.backend = registry.create(name.backend)
        self.shapes = self._method.shapes if name.kernels else self.backend.shapes
        if name.kernels:
            return
        if name.query not in queries(self.backend):
            answered = ", ".join(queries(self.backend))
            raise InputError(f'backend "{name.backend}" cannot be asked query {name.query}, only {answered}')
        set_accuracy(self.backend, tolerance)

    def tolerance(self, shape: Shape) -> float:
        """Of size, by how much a gap, or the gap at a time of impact, may be off as its library declares."""
        return _ROUNDING if self._name.kernels else self.backend.tolerance(shape)

    def asked_for(self, shape: Shape) -> float:
        """Of size, by how much it may be off because no more was asked for."""
        # whether a gap is too wide is decided exactly, and our spheres are solved in closed form
        exact = self._name.query == "tolerance" or (self._name.kernels and shape == "sphere")
        return 0.0 if exact else self._tolerance

    def load(self, scene: Scene) -> None:
        """Hold a scene."""
        self._scene, self._bodies = scene, len(scene.bodies)
        if not self._name.kernels:
            self._load_library(scene)
        elif self._name.query == "impact":
            self._impacts: ImpactFinder = self._method.impact_finder(scene, self._method.detection(scene))
        else:
            self._near: NearFinder = self._method.near_finder(scene, self._method.detection(scene))

    def _load_library(self, scene: Scene) -> None:
        self.backend.load(scene)
        if self._name.query == "impact":
            self._impacts = NativeImpacts(cast(Impacts, self.backend), scene)
        else:
            backend = cast(Distances, self.backend)
            self._near = NativeNearPairs(backend, scene, self._within, self._name.query)

    def near(self, positions: Floats, quaternions: Floats) -> NearPairs:
        """The near pairs at a pose, and how far apart they are where that is asked."""
        return self._near.checked(self._near.near(positions, quaternions))

    def impacts(self, motion: FrameMotion, duration: float) -> ImpactTimes:
        """The pairs that begin to touch in a frame, and when first, s after its start; sorted, each pair once.

        Parameters
        ----------
        motion : FrameMotion; if it is not the first, it goes on where that of the last call ended
        duration : s, of the frame
        """
        if motion.first:
            self._impacts.begin(half_moves(self._scene, motion.velocities, duration))
        pairs, times = self._impacts.checked(self._impacts.impacts(motion))
        order = np.lexsort((times, pairs[:, 1], pairs[:, 0]))
        _, first = np.unique(pairs[order, 0] * self._bodies + pairs[order, 1], return_index=True)
        return ImpactTimes(pairs[order][first], times[order][first])


def _stepped(method: Method) -> SteppedMethod:
    if not isinstance(method, SteppedMethod):
        raise InputError(f"{method.name.algorithm} computes events: it has no verdict on a pose")
    return method
