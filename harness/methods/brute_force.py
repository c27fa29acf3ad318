"""Brute force: every pair is put to FCL and every body to all six walls, every frame; the plan leaves nothing out."""

from __future__ import annotations

from typing import ClassVar

from harness.backends import registry
from harness.methods.culled import DETECTION, FCL_DECIDES
from harness.methods.query_stages import decide_exact_stages
from harness.methods.stages import Decisions, Plan
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.scene.scene import Scene

_FIXED = "brute force leaves nothing out; choose algorithm grid"


class BruteForce(SteppedMethod):
    """As the homework put every pair to PQP."""

    tests_everything: ClassVar[bool] = True

    def finding(self, count: int) -> str:
        return f"brute force: all {count * (count - 1) // 2} pairs are put to {self.name.backend} every frame"

    def decide_detection(self, scene: Scene, decisions: Decisions) -> None:
        count = len(scene.bodies)
        asked = count * (count - 1) // 2 - len(scene.ignored)
        for stage in DETECTION:
            if stage == "fcl":
                every = f"all {asked} pairs are put to FCL every frame"
                if len(scene.ignored):
                    every = f"{asked} pairs are put to FCL every frame, all but the {len(scene.ignored)} ignored"
                decisions.take("fcl", True, every, fixed=FCL_DECIDES)
            else:
                decisions.take(stage, False, "brute force puts every pair to FCL", fixed=_FIXED)

    def decide_cull(self, scene: Scene, near: str, decisions: Decisions) -> None:
        why = f"brute force puts all pairs to the kernels, whether their bounding spheres {near} or not"
        decisions.take("sphere_cull", False, why, fixed=_FIXED)
        decisions.take("size_classes", False, "nothing is culled", fixed=_FIXED)
        decide_exact_stages(self.name.query, scene, decisions)

    def no_detection(self, why: str, decisions: Decisions, *, fixed: str) -> None:
        for stage in DETECTION:
            decisions.take(stage, False, why, fixed=fixed)

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        backend = registry.create(self.name.backend)
        backend.load(scene)
        return backend


METHOD = BruteForce
