"""FCL's dynamic tree of axis-aligned boxes as the broad phase, and FCL alone for what the tree leaves."""

from __future__ import annotations

from collections.abc import Iterator

from harness.arrays import Floats
from harness.broadphase.pairs import BroadPhase
from harness.methods.culled import FCL_DECIDES, Culled, no_solids
from harness.methods.method import WarmUp
from harness.methods.stages import Decisions, Plan
from harness.methods.stepped import SteppedMethod
from harness.scene.scene import Scene


class Tree(Culled):
    """As `Culled`, but all of detection is FCL's, unless a stage is forced on."""

    @property
    def found_by(self) -> str:
        return "FCL's tree of boxes"

    def decide_size_classes(self, scene: Scene, decisions: Decisions) -> None:
        fixed = "a tree has no cells; choose algorithm grid"
        decisions.take("size_classes", False, "FCL's tree takes any sizes as they are", fixed=fixed)

    def decide_spheres(self, decisions: Decisions) -> None:
        fixed = no_solids(decisions)
        decisions.take("fcl", True, "FCL puts spheres whose boxes overlap to the test", fixed=FCL_DECIDES)
        decisions.take("containment", False, "a sphere is solid: inside is touching", fixed=fixed)

    def decide_hulls(self, scene: Scene, decisions: Decisions) -> bool:
        return decisions.take("hull_axis", False, "tree leaves close pairs to FCL")

    def broad_phase(self, scene: Scene, plan: Plan) -> BroadPhase:
        from harness.backends.fcl_tree import FclTree

        return FclTree(scene)

    def close_pairs_of(self, scene: Scene, plan: Plan, radii: Floats) -> BroadPhase:
        from harness.backends.fcl_tree import FclTree

        return FclTree(scene, radii)

    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        # kernels of the other stages are called only where they are forced on
        return super().warm_ups(meshes) if self.forced else SteppedMethod.warm_ups(self, meshes)


METHOD = Tree
