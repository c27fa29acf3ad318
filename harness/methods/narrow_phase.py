"""Whether close bodies touch, by their exact shape: by FCL alone, or by kernels, and FCL where they cannot prove it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.fcl_pair_test import FclPairTest
from harness.errors import InputError
from harness.methods.stages import Plan
from harness.narrowphase.containment import Containment
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.hull_pairs import HullPairs
from harness.narrowphase.mesh_pairs import MeshPairs
from harness.narrowphase.placement import Placement, Places
from harness.narrowphase.verdicts import PairVerdict, PairVerdicts, which
from harness.scene.hull import Hull, hull_of
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.threads import Threads

# A convex mesh may lie within its hull by 1e-9 of its diameter: its hull decides where it is by more.
ON_HULL = 1e-8

# Twice the area of a face, of a hull of diameter 1, above which its normal is known to 1e-6.
SLIVER = 1e-10


class NarrowPhase(Protocol):
    """Decides on close pairs, frame after frame, of the bodies of a scene."""

    @property
    def counters(self) -> Mapping[str, int]:
        """What was counted over all frames: `narrow_tests`, and what else is counted."""

    def touching(self, close: Pairs, positions: Floats, quaternions: Floats) -> Pairs:
        """Those of the pairs that touch.

        Parameters
        ----------
        close : (k, 2) int array, sorted; bodies whose bounding spheres touch
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z
        """


def narrow_phase(scene: Scene, plan: Plan, threads: Threads) -> NarrowPhase:
    """Of hulls or meshes, as the plan has it; threads share out the pairs that kernels decide on."""
    if not plan.keeps("hull_axis"):
        return FclNarrowPhase(scene)
    if scene.shape == "hull":
        return HullNarrowPhase(scene, threads)
    return MeshNarrowPhase(scene, threads, crossing=plan.keeps("crossing"), containment=plan.keeps("containment"))


class FclNarrowPhase:
    """Puts every pair to FCL, moving only the bodies in them."""

    def __init__(self, scene: Scene) -> None:
        self._fcl = FclPairTest(scene)

    @property
    def counters(self) -> dict[str, int]:
        return {"narrow_tests": self._fcl.tests, "fcl_tests": self._fcl.tests}

    def touching(self, close: Pairs, positions: Floats, quaternions: Floats) -> Pairs:
        return close[self._fcl.verdicts(close, positions, quaternions)] if len(close) else close


class HullNarrowPhase:
    """Settles hulls in a kernel, and puts to FCL only pairs nearer to touching than rounding can tell."""

    def __init__(self, scene: Scene, threads: Threads) -> None:
        self._fcl = FclPairTest(scene)
        self._places = Places(scene.bodies.sizes)
        self._hulls = HullPairs(hulls_of_size_1(scene), scene.mesh_of, MARGIN, threads)
        self._tests = 0

    @property
    def counters(self) -> dict[str, int]:
        return {"narrow_tests": self._tests, "hull_searches": self._hulls.searches, "fcl_tests": self._fcl.tests}

    def touching(self, close: Pairs, positions: Floats, quaternions: Floats) -> Pairs:
        if not len(close):
            return close
        self._tests += len(close)
        verdicts, _, undecided = self._hulls.settle(close, self._places.at(positions, quaternions))
        hit = which(verdicts, PairVerdict.TOUCHING)
        if undecided:
            left = np.flatnonzero(which(verdicts, PairVerdict.UNDECIDED))
            hit[left] = self._fcl.verdicts(close[left], positions, quaternions)
        touching: Pairs = close[hit]
        return touching


class MeshNarrowPhase:
    """Drops pairs whose hulls are proved separate and decides on the surfaces of the others; FCL decides the rest.

    Parameters
    ----------
    scene : Scene
    threads : that share out the pairs that kernels decide on
    crossing : look for triangles that cross before FCL is asked; else FCL has all that the hulls leave
    containment : look for meshes that are inside others

    Attributes
    ----------
    contained : (k, 2) int array, the pairs of the last frame of which one surface is inside the other; no hits
    """

    def __init__(self, scene: Scene, threads: Threads, *, crossing: bool = True, containment: bool = True) -> None:
        sizes, meshes, mesh_of = scene.bodies.sizes, scene.meshes, scene.mesh_of
        margin = max(ON_HULL if mesh.convex else MARGIN + overhang(mesh) for mesh in meshes)
        self._fcl = FclPairTest(scene)
        self._places = Places(sizes)
        self._hulls = HullPairs([mesh.hull for mesh in meshes], mesh_of, margin, threads)
        self._settle = MeshPairs(meshes, mesh_of, threads).settle if crossing else _all_undecided
        # Convex bodies that overlap touch, unless one contains the other, for which it must be larger.
        self._convex = np.array([mesh.convex for mesh in meshes])[mesh_of]
        self._any_convex = bool(self._convex.any())
        self._inside = Containment(meshes, mesh_of).contained if containment else _none_inside
        self._sizes = sizes
        self._hull_tests = self._tests = self._contained = 0
        self.contained: Pairs = np.empty((0, 2), np.int64)

    @property
    def counters(self) -> dict[str, int]:
        return {
            "narrow_tests": self._tests,
            "hull_tests": self._hull_tests,
            "hull_searches": self._hulls.searches,
            "fcl_tests": self._fcl.tests,
            "contained_pairs": self._contained,
        }

    def touching(self, close: Pairs, positions: Floats, quaternions: Floats) -> Pairs:
        self.contained = close[:0]
        if not len(close):
            return close
        self._hull_tests += len(close)
        placement = self._places.at(positions, quaternions)
        verdicts, _, _ = self._hulls.settle(close, placement)
        may_touch = ~which(verdicts, PairVerdict.SEPARATE)
        if self._any_convex:
            convex = self._convex[close[:, 0]] & self._convex[close[:, 1]]
            self._tests += int(np.count_nonzero(convex | may_touch))  # NumPy 2.4 gives a number that JSON refuses
            close, verdicts, convex = close[may_touch], verdicts[may_touch], convex[may_touch]
            same_size = self._sizes[close[:, 0]] == self._sizes[close[:, 1]]
            asked = np.flatnonzero(which(verdicts, PairVerdict.UNDECIDED) | ~(convex & same_size))
            verdicts[asked] = self._settle(close[asked], placement)
        else:
            close = close[may_touch]
            self._tests += len(close)
            verdicts = self._settle(close, placement)
        hit = which(verdicts, PairVerdict.TOUCHING)
        left = np.flatnonzero(which(verdicts, PairVerdict.UNDECIDED))
        if len(left):
            hit[left] = self._fcl.verdicts(close[left], positions, quaternions)
        self.contained = self._inside(close[~hit], placement)
        self._contained += len(self.contained)
        touching: Pairs = close[hit]
        return touching


def hulls_of_size_1(scene: Scene) -> list[Hull]:
    """The hulls that the bodies have in their sizes, a mesh each.

    Raises
    ------
    InputError
        If each size is given a hull of its own: the kernels hold one for all.
    """
    hulls = [mesh.hull for mesh in scene.meshes]
    if len(scene.hulls) != len({mesh for mesh, _ in scene.hulls}):
        raise InputError("it holds one hull for bodies of all sizes, and cannot take one for each size")
    for (mesh, size), hull in scene.hulls.items():
        hulls[mesh] = hull_of(hull.vertices / size, hull.faces)
    return hulls


def _all_undecided(pairs: Pairs, placement: Placement) -> PairVerdicts:
    return np.full(len(pairs), PairVerdict.UNDECIDED, np.int8)


def _none_inside(pairs: Pairs, placement: Placement) -> Pairs:
    return pairs[:0]


def overhang(mesh: Mesh) -> float:
    """How far a mesh sticks out of its hull, of its diameter: as far as its builder rounds."""
    a, b, c = (mesh.hull.vertices[mesh.hull.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    proper = areas > SLIVER  # the normal of a face without area is noise
    normals = normals[proper] / areas[proper, None]
    heights = np.einsum("ij,ij->i", normals, a[proper])
    return max(float((mesh.vertices @ n - h).max()) for n, h in zip(normals, heights, strict=True))
