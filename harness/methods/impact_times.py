"""Pairs that begin to touch from one frame to the next, and when: a broad phase of moving spheres, then kernels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

import numpy as np

from harness.arrays import Floats
from harness.backends.protocol import ImpactTimes
from harness.broadphase.pairs import BroadPhase
from harness.methods.narrow_phase import hulls_of_size_1
from harness.narrowphase.body_shapes import hulls_of_bodies, shapes_of_bodies
from harness.narrowphase.frame_flights import FrameFlights
from harness.narrowphase.gjk import LEAST_GAP
from harness.narrowphase.impact_pairs import (
    OnsetCount,
    Onsets,
    PairsAsked,
    hull_pair_onsets,
    mesh_pair_onsets,
    onsets_of,
    sphere_pair_onsets,
)
from harness.narrowphase.mesh_advancement import mesh_shape
from harness.narrowphase.pair_states import PAIR_STATE
from harness.narrowphase.support import support_map
from harness.scene.scene import Scene

# Relative: by how much more than their way spheres are grown, so that rounding loses no pair.
SLACK = 1e-9


class FrameMotion(NamedTuple):
    """How the bodies of a scene move from one frame to the next.

    Attributes
    ----------
    positions, quaternions : (n, 3) m and (n, 4), at the start
    middle : (n, 3) m, where the centres are in the middle
    velocities, spins : (n, 3) m/s and rad/s, at the start
    first : whether it is the first frame
    duration : s
    """

    positions: Floats
    quaternions: Floats
    middle: Floats
    velocities: Floats
    spins: Floats
    first: bool
    duration: float


def half_moves(scene: Scene, velocities: Floats, duration: float) -> Floats:
    """(n,) m: no body comes farther from where it is in the middle of a frame.

    Parameters
    ----------
    scene : Scene
    velocities : (n, 3) m/s; a folded path is never farther from its middle than its speed allows
    duration : s, of a frame; of no effect on recorded poses, of which the longest way of all is taken
    """
    if scene.poses is not None:
        return 0.5 * scene.poses.farthest_moves
    moves: Floats = 0.5 * duration * np.linalg.norm(velocities, axis=1)
    return moves


class ImpactFinder(Protocol):
    """Finds the pairs of a scene that begin to touch, frame after frame, each as long as the last."""

    @property
    def counters(self) -> Mapping[str, float]:
        """What was counted over all frames, if anything is."""

    def begin(self, moves: Floats) -> None:
        """Begin anew, with frames in which bodies come no farther from their middle than (n,) m."""

    def impacts(self, motion: FrameMotion) -> ImpactTimes:
        """Pairs that begin to touch in the next frame, and when; a pair may stand there more than once."""

    def checked(self, found: ImpactTimes) -> ImpactTimes:
        """The answer, if it keeps to its form; asked outside of every clock."""


class KernelImpacts:
    """Impacts by kernels.

    Parameters
    ----------
    scene : Scene
    broad_phase : makes one for spheres of these radii (n,) m
    tolerance : of the mean size of a pair, the gap at which hulls and surfaces count as touching
    """

    def __init__(self, scene: Scene, broad_phase: Callable[[Floats], BroadPhase], tolerance: float) -> None:
        self._scene, self._make, self._tolerance = scene, broad_phase, tolerance
        self._inner_half = scene.box.half - scene.bodies.radii[:, None]
        self._search, self._reach = _search_of(scene)
        self._tests = self._given_up = 0
        self._spheres = scene.shape == "sphere"

    @property
    def counters(self) -> dict[str, float]:
        tests: dict[str, float] = {"pair_tests": self._broad_phase.pair_tests, "narrow_tests": self._tests}
        return tests if self._spheres else {**tests, "unfollowed_contacts": self._given_up}

    def begin(self, moves: Floats) -> None:
        self._tests = self._given_up = 0
        self._before = np.empty(0, PAIR_STATE)
        self._velocities = self._spins = np.full_like(self._scene.bodies.spins, np.nan)
        sizes = self._scene.bodies.sizes
        near = max(self._tolerance, 2.0 * LEAST_GAP) * sizes
        self._broad_phase = self._make((self._scene.enclosing_radii + moves + near) * (1.0 + SLACK))
        self._found = onsets_of(0, 64)

    def impacts(self, motion: FrameMotion) -> ImpactTimes:
        close = self._broad_phase.close_pairs(motion.middle)
        self._tests += len(close)
        flights = FrameFlights(
            motion.positions,
            motion.quaternions,
            motion.velocities,
            motion.spins,
            self._inner_half,
            self._scene.bodies.sizes,
            self._reach,
            motion.duration,
            np.inf if self._scene.poses is None else motion.duration,
        )
        steady = ((motion.velocities == self._velocities) & (motion.spins == self._spins)).all(axis=1)
        self._velocities, self._spins = motion.velocities.copy(), motion.spins.copy()
        asked = PairsAsked(close, self._before, steady, motion.first, self._tolerance)
        if len(close) > len(self._found.pairs):  # a pair seldom begins to touch twice in a frame
            self._found = onsets_of(0, 2 * len(close))
        found = Onsets(self._found.pairs, self._found.times, np.empty(len(close), PAIR_STATE))
        count = self._search(asked, flights, found)
        if count.onsets > len(found.pairs):  # count first, then make room: rare, as the room is kept
            found = self._found = onsets_of(len(close), 2 * count.onsets)
            count = self._search(asked, flights, found)
        self._given_up += count.given_up
        self._before = found.states
        return ImpactTimes(close[found.pairs[: count.onsets]], found.times[: count.onsets].copy())

    def checked(self, found: ImpactTimes) -> ImpactTimes:
        return found


class _Search(Protocol):
    def __call__(self, asked: PairsAsked, flights: FrameFlights, found: Onsets) -> OnsetCount:
        """Search a frame."""


def _search_of(scene: Scene) -> tuple[_Search, float]:
    """What searches a frame of the bodies of a scene, and how far they reach from their centres, of size."""
    if scene.shape == "sphere":
        return sphere_pair_onsets, 0.5
    if scene.shape == "hull":
        vertices = [hull.vertices for hull in hulls_of_size_1(scene)]
        hulls = hulls_of_bodies([support_map(of_mesh) for of_mesh in vertices], scene.mesh_of)
        reach = max(float(np.linalg.norm(of_mesh, axis=1).max()) for of_mesh in vertices)
        return lambda asked, flights, found: hull_pair_onsets(asked, flights, hulls, found), reach
    shapes = shapes_of_bodies([mesh_shape(mesh, followed=True) for mesh in scene.meshes], scene.mesh_of)
    return lambda asked, flights, found: mesh_pair_onsets(asked, flights, shapes, found), shapes.radius
