"""Pairs whose gap is at most a distance, and how far apart they are: a broad phase, then kernels; no library."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from harness.arrays import Flags, Floats, Pairs
from harness.backends.protocol import NearPairs
from harness.broadphase.pairs import BroadPhase
from harness.methods.narrow_phase import hulls_of_size_1
from harness.narrowphase.gap import Accuracy
from harness.narrowphase.gap_pairs import HullGapPairs, MeshGapPairs
from harness.narrowphase.placement import Places
from harness.narrowphase.pose_gaps import Gaps
from harness.narrowphase.sphere_gap_pairs import SphereGapPairs
from harness.scene.scene import Scene
from harness.vocabulary import Query


class NearFinder(Protocol):
    """Finds all pairs of a scene that are near, at given poses."""

    @property
    def counters(self) -> Mapping[str, float]:
        """What was counted over all frames, if anything is."""

    def near(self, positions: Floats, quaternions: Floats) -> NearPairs:
        """Pairs that are near; positions (n, 3) in m, quaternions (n, 4) unit, w x y z."""

    def checked(self, found: NearPairs) -> NearPairs:
        """The answer, if it keeps to its form; asked outside of every clock."""


class KernelNearPairs:
    """Near pairs by kernels, each from what it ended with in the last frame.

    Parameters
    ----------
    scene : Scene
    broad_phase : that passes on every pair whose gap may be at most `within`
    query : "distance"; or "tolerance", which needs no gap, but whether it is too wide
    within : m
    tolerance : of the smallest size, by how much a gap may be too large
    """

    def __init__(self, scene: Scene, broad_phase: BroadPhase, query: Query, within: float, tolerance: float) -> None:
        self._broad_phase, self._within = broad_phase, within
        self._gaps = gap_search(scene)
        smallest = float(scene.bodies.sizes.min(initial=np.inf))
        deciding = Accuracy(within, within, 0.0)
        self._accuracy = deciding if query == "tolerance" else Accuracy(within, 0.0, tolerance * smallest)
        # a gap whose bounds leave open whether it is too wide is searched again, until they do not
        self._deciding_gaps, self._deciding = gap_search(scene), deciding
        self._tests = 0

    @property
    def counters(self) -> dict[str, float]:
        return {"pair_tests": self._broad_phase.pair_tests, "narrow_tests": self._tests}

    def near(self, positions: Floats, quaternions: Floats) -> NearPairs:
        close = self._broad_phase.close_pairs(positions)
        self._tests += len(close)
        gaps, points = self._gaps(close, positions, quaternions, self._accuracy)
        undecided = (gaps > self._within) & (gaps < np.inf)
        if undecided.any():
            self._decide(undecided, close, positions, quaternions, Gaps(gaps, points))
        near = gaps <= self._within
        return NearPairs(close[near], gaps[near], points[near])

    def checked(self, found: NearPairs) -> NearPairs:
        return found

    def _decide(self, undecided: Flags, close: Pairs, positions: Floats, quaternions: Floats, found: Gaps) -> None:
        decided = self._deciding_gaps(close[undecided], positions, quaternions, self._deciding)
        found.gaps[undecided], found.points[undecided] = decided.gaps, decided.points


class GapSearch(Protocol):
    def __call__(self, pairs: Pairs, positions: Floats, quaternions: Floats, accuracy: Accuracy) -> Gaps:
        """The gaps of pairs, m; the accuracy in m."""


def gap_search(scene: Scene) -> GapSearch:
    """What measures the gaps of the bodies of a scene, frame after frame."""
    if scene.shape == "sphere":
        spheres = SphereGapPairs(scene.bodies.radii)
        return lambda pairs, positions, quaternions, accuracy: spheres.gaps(pairs, positions, accuracy.limit)
    places = Places(scene.bodies.sizes)
    solids: HullGapPairs | MeshGapPairs = (
        HullGapPairs(hulls_of_size_1(scene), scene.mesh_of)
        if scene.shape == "hull"
        else MeshGapPairs(scene.meshes, scene.mesh_of)
    )

    def search(pairs: Pairs, positions: Floats, quaternions: Floats, accuracy: Accuracy) -> Gaps:
        placement = places.at(positions, quaternions)
        units = (placement.scale * part for part in accuracy)
        return solids.gaps(pairs, placement, Accuracy(*units))

    return search
