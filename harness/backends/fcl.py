"""FCL through python-fcl: exact spheres, hulls and triangle meshes; the broad phase is ours."""

from __future__ import annotations

from itertools import chain, combinations, compress, repeat

import fcl
import numpy as np

from harness.arrays import Floats, Pairs
from harness.narrowphase.fcl_objects import FclObjects
from harness.scene.scene import Scene, Shape


class Fcl:
    """Brute force: every pair is put to FCL at every call."""

    name = "fcl"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals; the rare worst case for hulls."""
        return {"sphere": 1e-15, "hull": 1e-11, "mesh": 1e-14}[shape]

    def load(self, scene: Scene) -> None:
        self._bodies = FclObjects(scene)
        self._request = fcl.CollisionRequest()
        self.counters = {"pair_tests": 0, "narrow_tests": 0}

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        self._bodies.place(positions, quaternions)
        objects = self._bodies.objects
        count = len(objects)
        # A result is reused because making one costs as much as a far pair, but for one call only: it keeps every
        # contact it was ever given, and its own verdict is sticky. What `collide` returns is the pair's verdict.
        result = fcl.CollisionResult()
        first = chain.from_iterable(map(repeat, objects, range(count - 1, -1, -1)))
        second = chain.from_iterable(objects[i:] for i in range(1, count))
        verdicts = map(fcl.collide, first, second, repeat(self._request), repeat(result))
        touching = list(compress(combinations(range(count), 2), verdicts))
        tests = count * (count - 1) // 2
        self.counters["pair_tests"] += tests
        self.counters["narrow_tests"] += tests
        return np.array(touching, np.int64).reshape(-1, 2)
