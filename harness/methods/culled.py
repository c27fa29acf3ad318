"""Cull, then decide: a broad phase finds the pairs whose bounding spheres touch, and the exact shape decides on those.

Each stage of detection passes fewer pairs on: the bounding spheres those that are close, the hulls those whose hulls
overlap (for shape `hull` they decide), the search for a crossing those that it can neither prove to touch nor to be
apart, and FCL decides the rest. Any broad phase of `harness.broadphase` is used like this.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from harness.arrays import Floats, Pairs
from harness.broadphase.ignored import asked_about
from harness.broadphase.pairs import BroadPhase, Shareable
from harness.broadphase.scheme import Scheme, scheme_of
from harness.methods.method import WarmUp
from harness.methods.query_stages import decide_exact_stages
from harness.methods.stages import Decisions, Plan, span_of
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.methods.warm_up_scene import TOUCHING, of_meshes, two_bodies
from harness.narrowphase.containment import Containment
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.hull_pairs import HullPairs
from harness.narrowphase.mesh_pairs import MeshPairs
from harness.narrowphase.placement import Places
from harness.scene.scene import Scene
from harness.threads import Threads

if TYPE_CHECKING:
    from harness.methods.narrow_phase import NarrowPhase

DETECTION = ("sphere_cull", "size_classes", "hull_axis", "crossing", "fcl", "containment")
"""The stages of detection, in order."""

FCL_DECIDES = "what the other stages leave open would stay so"


class Culled(SteppedMethod):
    """Detection by a broad phase and kernels; FCL decides what they cannot prove."""

    leaves_out: ClassVar[bool] = True

    @property
    def scheme(self) -> Scheme:
        """The broad phase."""
        return scheme_of(self.name.algorithm)

    def finding(self, count: int) -> str:
        return f"{self.name.algorithm} finds the touching pairs"

    def no_detection(self, why: str, decisions: Decisions, *, fixed: str) -> None:
        for stage in DETECTION:
            decisions.take(stage, False, why, fixed=fixed)

    def decide_detection(self, scene: Scene, decisions: Decisions) -> None:
        alone = f"without its cull, {self.name.algorithm} would be brute-force; choose that"
        only = "only pairs whose bounding spheres touch go on"
        decisions.take("sphere_cull", True, f"{only}, found by {self.found_by}", fixed=alone)
        self.decide_size_classes(scene, decisions)
        if scene.shape == "sphere":
            self.decide_spheres(decisions)
        else:
            self._decide_solids(scene, decisions)

    def decide_cull(self, scene: Scene, near: str, decisions: Decisions) -> None:
        alone = f"without its cull, {self.name.algorithm} would be brute-force; choose that"
        why = f"only pairs whose bounding spheres {near} go on, found by {self.found_by}"
        decisions.take("sphere_cull", True, why, fixed=alone)
        self.decide_size_classes(scene, decisions)
        decide_exact_stages(self.name.query, scene, decisions)

    def close_pairs_of(self, scene: Scene, plan: Plan, radii: Floats) -> BroadPhase:
        return self.scheme.make(radii, scene.box, plan.keeps("size_classes"))

    @property
    def found_by(self) -> str:
        """What finds the close pairs."""
        return self.scheme.found_by

    def decide_size_classes(self, scene: Scene, decisions: Decisions) -> None:
        """Whether bodies of different sizes are kept apart."""
        sizes, classes = scene.bodies.sizes, self.scheme.size_classes
        if not classes:
            why = f"{self.found_by} takes any sizes as they are"
            decisions.take("size_classes", False, why, fixed=why)
        elif equal_sizes(scene):
            decisions.take("size_classes", False, "all bodies are of one size, so that one level of cells fits all")
        else:
            decisions.take("size_classes", True, f"sizes from {sizes.min():.3g} to {sizes.max():.3g} m: {classes}")

    def decide_spheres(self, decisions: Decisions) -> None:
        """The stages of detection that decide on spheres."""
        fixed = no_solids(decisions)
        why = "spheres that touch are hits as they are: no library is asked"
        decisions.take("fcl", False, why, fixed="the test of the cull is exact for spheres already")
        decisions.take("containment", False, "a sphere is solid: inside is touching", fixed=fixed)

    def decide_hulls(self, scene: Scene, decisions: Decisions) -> bool:
        """Whether the hulls of close pairs are put to a kernel."""
        vertices = span_of([len(mesh.hull.vertices) for mesh in scene.meshes])
        if scene.shape == "hull":
            why = f"the hulls of {vertices} vertices are settled by separating axis and GJK"
        else:
            why = f"only pairs whose hulls ({vertices} vertices) overlap go on, by separating axis and GJK"
        return decisions.take("hull_axis", True, why)

    def _decide_solids(self, scene: Scene, decisions: Decisions) -> None:
        hulls = self.decide_hulls(scene, decisions)
        crossing = _decide_crossing(scene, hulls, decisions)
        left = "what rounding leaves open of the hulls" if scene.shape == "hull" else "what the hulls leave open"
        if not hulls:
            left = "all close pairs"
        elif crossing:
            left = "what the search for a crossing leaves open"
        decisions.take("fcl", True, f"FCL decides {left}", fixed=FCL_DECIDES)
        _decide_containment(scene, hulls, decisions)

    def broad_phase(self, scene: Scene, plan: Plan) -> BroadPhase:
        """A new broad phase for the bodies of a scene."""
        return self.scheme.make(scene.enclosing_radii, scene.box, plan.keeps("size_classes"))

    def warnings(self, scene: Scene) -> tuple[str, ...]:
        if self.threads == 1:
            return ()
        return (f"{self.threads} THREADS: CPU times are sums over them; elapsed times tell what they save",)

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        threads, found = Threads(self.threads), self.broad_phase(scene, plan)
        if isinstance(found, Shareable):
            found.share_with(threads)
        broad_phase = asked_about(found, scene.ignored)
        if scene.shape == "sphere":
            return CloseSpheres(broad_phase)
        # only a scene of hulls or meshes needs FCL, and then it is imported
        from harness.methods.narrow_phase import narrow_phase

        return CulledDetector(broad_phase, narrow_phase(scene, plan, threads))

    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        yield from super().warm_ups(meshes)
        if self.name.query != "collision":
            return
        algorithm = self.name.algorithm
        yield f"close pairs of {algorithm}", partial(_find_close_pairs, self)
        if self.threads > 1:
            yield f"close pairs of {algorithm} by threads", partial(_share_close_pairs, self)
        if self.name.shape != "sphere":
            yield f"pairs of hulls{of_meshes(meshes)}", partial(_settle_hulls, meshes)
        if self.name.shape == "mesh":
            yield f"pairs of meshes{of_meshes(meshes)}", partial(_settle_meshes, meshes)


class CloseSpheres:
    """Pairs of spheres that touch: what the broad phase finds is the answer."""

    def __init__(self, broad_phase: BroadPhase) -> None:
        self._broad_phase = broad_phase

    @property
    def counters(self) -> dict[str, float]:
        tests = self._broad_phase.pair_tests
        return {"pair_tests": tests, "narrow_tests": tests, **_cells(self._broad_phase)}

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return self._broad_phase.close_pairs(positions)


class CulledDetector:
    """Pairs whose bounding spheres touch, put to their exact shape.

    Parameters
    ----------
    broad_phase, narrow_phase : of the same scene
    """

    def __init__(self, broad_phase: BroadPhase, narrow_phase: NarrowPhase) -> None:
        self._broad_phase, self._narrow_phase = broad_phase, narrow_phase

    @property
    def counters(self) -> dict[str, float]:
        return {"pair_tests": self._broad_phase.pair_tests, **self._narrow_phase.counters, **_cells(self._broad_phase)}

    @property
    def contained(self) -> Pairs:
        """(k, 2) int array: pairs of the last frame of which one mesh is wholly inside the other, where that is looked
        for. Their surfaces do not touch, so that they are no hits."""
        found: Pairs = getattr(self._narrow_phase, "contained", np.empty((0, 2), np.int64))
        return found

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        close = self._broad_phase.close_pairs(positions)
        return self._narrow_phase.touching(close, positions, quaternions)


def _cells(broad_phase: BroadPhase) -> dict[str, float]:
    """How many cells a body overlapped in the last frame, the most and the mean, if the broad phase has cells."""
    if not hasattr(broad_phase, "cells_per_body"):
        return {}
    most, mean = broad_phase.cells_per_body()
    return {"cells_per_body_most": most, "cells_per_body": mean}


def no_solids(decisions: Decisions) -> str:
    """Leave out what spheres do not have; why it cannot be forced."""
    fixed = "spheres have no hull and no surface of triangles"
    for stage in ("hull_axis", "crossing"):
        decisions.take(stage, False, "a sphere is its own bounding sphere", fixed=fixed)
    return fixed


def _decide_crossing(scene: Scene, hulls: bool, decisions: Decisions) -> bool:
    if scene.shape == "hull":
        fixed = "a hull that overlaps touches, whether its surface crosses another or not"
        return decisions.take("crossing", False, "the shape is the hull", fixed=fixed)
    if not hulls:
        fixed = "it starts from pairs whose hulls overlap; keep hull_axis"
        return decisions.take("crossing", False, "without the hulls' verdict FCL has all close pairs", fixed=fixed)
    convex = sum(mesh.convex for mesh in scene.meshes)
    several = len(scene.meshes) > 1
    if convex == len(scene.meshes) and equal_sizes(scene):
        what = "all meshes are convex, thus their own hulls," if several else "the mesh is convex, thus its own hull,"
        return decisions.take("crossing", False, f"{what} and of one size: whether the hulls overlap decides")
    if convex == len(scene.meshes):
        what = "all meshes are convex" if several else "the mesh is convex"
        why = f"{what}, but of bodies of different sizes one may be inside the other, which is no hit"
    else:
        concave = len(scene.meshes) - convex
        verb = "are" if concave > 1 else "is"
        what = f"{concave} of {len(scene.meshes)} meshes {verb}" if several else "the mesh is"
        why = f"{what} not convex: two triangles that cross prove a hit, a full traversal that there is none"
        if convex and equal_sizes(scene):
            why += "; of two convex ones the hulls decide"
    return decisions.take("crossing", True, f"{why} ({span_of([len(mesh.faces) for mesh in scene.meshes])} faces)")


def _decide_containment(scene: Scene, hulls: bool, decisions: Decisions) -> None:
    if scene.shape == "hull":
        fixed = "a hull inside another is a hit"
        decisions.take("containment", False, "a hull is solid: inside is touching", fixed=fixed)
    elif not hulls:
        fixed = "it is asked of pairs whose hulls overlap; keep hull_axis"
        decisions.take("containment", False, "without the hulls' verdict it is not looked for", fixed=fixed)
    elif equal_sizes(scene):
        decisions.take("containment", False, "of bodies of one size none can be inside another")
    else:
        fixed = "contained pairs would go uncounted"
        why = "a mesh wholly inside a larger one is no hit, and counted apart"
        decisions.take("containment", True, why, fixed=fixed)


def equal_sizes(scene: Scene) -> bool:
    """Whether all bodies are of one size."""
    sizes = scene.bodies.sizes
    return bool((sizes == sizes[:1]).all())


def _find_close_pairs(method: Culled) -> None:
    scene = two_bodies("sphere")
    found = CloseSpheres(method.broad_phase(scene, method.detection(scene)))
    found.pairs(scene.bodies.positions, scene.bodies.quaternions)
    _ = found.counters  # what is counted is compiled as well


def _share_close_pairs(method: Culled) -> None:
    scene = two_bodies("sphere")
    found = method.broad_phase(scene, method.detection(scene))
    if isinstance(found, Shareable):
        found.compile_shared()


def _settle_hulls(meshes: int) -> None:
    scene = two_bodies("hull", meshes)
    bodies, hulls = scene.bodies, [mesh.hull for mesh in scene.meshes]
    placement = Places(bodies.sizes).at(bodies.positions, bodies.quaternions)
    HullPairs(hulls, scene.mesh_of, MARGIN).settle(TOUCHING, placement)


def _settle_meshes(meshes: int) -> None:
    scene = two_bodies("mesh", meshes)
    bodies = scene.bodies
    placement = Places(bodies.sizes).at(bodies.positions, bodies.quaternions)
    MeshPairs(scene.meshes, scene.mesh_of).settle(TOUCHING, placement)
    Containment(scene.meshes, scene.mesh_of).contained(TOUCHING, placement)


METHOD = Culled
