"""A backend asked for near pairs and for impacts, in the form in which methods of this program answer them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import numpy as np

from harness.arrays import Flags, Floats, Pairs
from harness.backends.contract import made, read_only, require_counters, require_gaps, require_impacts, require_pairs
from harness.backends.protocol import Distances, Impacts, ImpactTimes, Near, NearPairs
from harness.methods.impact_times import FrameMotion
from harness.motion.kinematics import turn
from harness.scene.ignored_pairs import kept as kept_of
from harness.scene.scene import Scene
from harness.vocabulary import Query


class NativeNearPairs:
    """Near pairs as a backend finds them.

    Parameters
    ----------
    backend : loaded
    scene : Scene
    within : m
    query : "distance"; or "tolerance", for which a backend that can is asked for pairs without their gaps
    """

    def __init__(self, backend: Distances | Near, scene: Scene, within: float, query: Query = "distance") -> None:
        self._backend, self._count, self._within = backend, len(scene.bodies), within
        self._ignored = scene.ignored
        self._gapless = query == "tolerance" and isinstance(backend, Near)

    @property
    def counters(self) -> Mapping[str, float]:
        return require_counters(self._backend.name, getattr(self._backend, "counters", {}))

    def near(self, positions: Floats, quaternions: Floats) -> NearPairs:
        poses = read_only(positions), read_only(quaternions)
        if not self._gapless:
            return cast(NearPairs, made(cast(Distances, self._backend).distances(*poses, self._within)))
        pairs = cast(Pairs, made(cast(Near, self._backend).near(*poses, self._within)))
        return NearPairs(pairs, np.full(len(pairs), np.nan), None)

    def checked(self, found: NearPairs) -> NearPairs:
        if self._gapless:
            found = found._replace(pairs=require_pairs(self._backend.name, found.pairs, self._count))
        else:
            found = require_gaps(self._backend.name, found, self._count, self._within)
        if not len(self._ignored):
            return found
        kept = kept_of(found.pairs, self._ignored)
        return NearPairs(found.pairs[kept], found.gaps[kept], None if found.points is None else found.points[kept])


class NativeImpacts:
    """Impacts as a backend finds them, which moves every body straight: a frame is cut wherever a wall turns one.

    Parameters
    ----------
    backend : loaded
    scene : Scene
    """

    def __init__(self, backend: Impacts, scene: Scene) -> None:
        self._backend, self._count, self._ignored = backend, len(scene.bodies), scene.ignored
        self._inner_half = scene.box.half - scene.bodies.radii[:, None]

    @property
    def counters(self) -> Mapping[str, float]:
        return require_counters(self._backend.name, getattr(self._backend, "counters", {}))

    def begin(self, moves: Floats) -> None:
        """A backend finds close pairs by itself."""

    def impacts(self, motion: FrameMotion) -> ImpactTimes:
        positions, velocities = motion.positions.copy(), motion.velocities.copy()
        velocities[self._inner_half <= 0.0] = 0.0  # a body as wide as the box stays in the middle
        quaternions, now, parts = motion.quaternions, 0.0, []
        while True:
            waits = self._until_walls(positions, velocities)
            wait = min(float(waits.min(initial=np.inf)), motion.duration - now)
            pairs, times = self._piece(positions, quaternions, velocities, motion.spins, wait)
            parts.append((pairs, now + times))
            if now + wait >= motion.duration:
                break
            now += wait
            positions += velocities * wait
            self._fold(waits <= wait, positions, velocities)
            quaternions = np.empty_like(motion.quaternions)
            turn(motion.quaternions, motion.spins, now, quaternions)
        pairs, times = np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
        order = np.lexsort((times, pairs[:, 1], pairs[:, 0]))
        return ImpactTimes(pairs[order], times[order])

    def checked(self, found: ImpactTimes) -> ImpactTimes:
        return found

    def _piece(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, wait: float
    ) -> ImpactTimes:
        found = self._backend.impacts(
            read_only(positions), read_only(quaternions), read_only(velocities), read_only(spins), wait
        )
        found = require_impacts(self._backend.name, found, self._count, wait)
        if not len(self._ignored):
            return found
        kept = kept_of(found.pairs, self._ignored)
        return ImpactTimes(found.pairs[kept], found.times[kept])

    def _until_walls(self, positions: Floats, velocities: Floats) -> Floats:
        """(n, 3) s: until each body is turned on each axis; inf where it does not move."""
        ahead = np.where(velocities > 0.0, self._inner_half, -self._inner_half)
        with np.errstate(divide="ignore", invalid="ignore"):
            waits = np.maximum((ahead - positions) / velocities, 0.0)
        return np.where(velocities == 0.0, np.inf, waits)

    def _fold(self, turned: Flags, positions: Floats, velocities: Floats) -> None:
        positions[turned] = np.copysign(self._inner_half, velocities)[turned]
        velocities[turned] *= -1.0
