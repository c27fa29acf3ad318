"""A backend's own pipeline as a whole: its stages are not known, so that none can be left out."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from importlib import import_module
from typing import Any, cast

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends import registry
from harness.backends.all_but_ignored import AllButIgnored
from harness.backends.protocol import Backend, Distances, Impacts, ImpactTimes, NearPairs, queries, set_accuracy
from harness.backends.statement import approximation
from harness.errors import InputError
from harness.methods.impact_times import ImpactFinder
from harness.methods.method import WarmUp
from harness.methods.native_queries import NativeImpacts, NativeNearPairs
from harness.methods.near_pairs import NearFinder
from harness.methods.query_pipelines import ImpactPipeline, NearPipeline
from harness.methods.stages import Plan
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.methods.warm_up_scene import two_bodies
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import MethodName


class Native(SteppedMethod):
    """Asks a backend for all touching pairs."""

    def backend(self) -> Backend:
        """A new backend, not loaded yet."""
        return registry.create(self.name.backend)

    def finding(self, count: int) -> str:
        return f"{self.name.backend} finds the touching pairs by itself"

    def warnings(self, scene: Scene) -> tuple[str, ...]:
        replaced = approximation(self.name.backend, scene.shape) if len(scene.bodies) > 1 else None
        return (f"APPROXIMATION: {replaced}",) if replaced else ()

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        backend = self._loaded(scene)
        return AllButIgnored(backend, scene.ignored) if len(scene.ignored) else backend

    def near_finder(self, scene: Scene, plan: Plan) -> NearFinder:
        return NativeNearPairs(cast(Distances, self._loaded(scene)), scene, self.within or 0.0, self.name.query)

    def impact_finder(self, scene: Scene, plan: Plan) -> ImpactFinder:
        return NativeImpacts(cast(Impacts, self._loaded(scene)), scene)

    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        if self.name.query == "collision":
            yield from super().warm_ups(meshes)
        else:
            yield f"frames around {self.name.query}", partial(_compile_around, self.name)

    def _loaded(self, scene: Scene) -> Backend:
        """The backend, holding the scene.

        Raises
        ------
        InputError
            If its library is missing, or it has no such shape or query.
        """
        backend, query = self.backend(), self.name.query
        if scene.shape not in backend.shapes:
            raise InputError(f'backend "{backend.name}" has no shape {scene.shape}, only {", ".join(backend.shapes)}')
        if query not in queries(backend):
            answered = ", ".join(queries(backend))
            raise InputError(f'backend "{backend.name}" cannot be asked query {query}, only {answered}')
        if query != "collision":
            set_accuracy(backend, self.tolerance)
        backend.load(scene)
        return backend


class _FindsNothing:
    """In the place of a backend for the warm-up, which compiles only what is around it: it finds nothing."""

    name = "nothing"

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        return NearPairs(_NO_PAIRS, np.empty(0), None)

    def impacts(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, duration: float
    ) -> ImpactTimes:
        return ImpactTimes(_NO_PAIRS, np.empty(0))


_NO_PAIRS: Pairs = np.empty((0, 2), np.int64)


def _compile_around(name: MethodName) -> None:
    import_module("harness.backends.rotations")  # half a second which each run would spend once it asks a library
    scene, law, method = two_bodies(name.shape), MotionLaw(0.6, 0.3, "none"), Native(name)
    plan, stand_in = method.plan(scene, law), cast(Any, _FindsNothing())
    near, impacts = NativeNearPairs(stand_in, scene, 1.0), NativeImpacts(stand_in, scene)
    for pipeline in (NearPipeline(scene, plan, near, gaps=True), ImpactPipeline(scene, plan, impacts)):
        pipeline.fly(law, traced=True)


METHOD = Native
