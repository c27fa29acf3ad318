"""FCL through python-fcl: exact spheres, hulls and meshes, every pair put to it."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain, combinations, compress, repeat
from typing import TypeVar

import fcl
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.fcl_objects import MISSED_BY_UNLIKE, MOST_UNLIKE, UNITS, FclObjects, size_ratio
from harness.scene.scene import Scene
from harness.vocabulary import Shape

# Up to so many bodies the pairs are kept in lists (8 MB), which saves a tenth of the time.
MOST_LISTED = 1000

T = TypeVar("T")


class Fcl:
    """Every pair, every frame. Methods of this program ask FCL about single pairs: see `FclPairTest`."""

    name = "fcl"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    units = UNITS
    precision = "double"
    _size_ratio = 1.0

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals, the rare worst case for hulls; once loaded, for the sizes of the scene."""
        if shape == "hull" and self._size_ratio > MOST_UNLIKE:
            return MISSED_BY_UNLIKE
        return {"sphere": 1e-15, "hull": 1e-11, "mesh": 1e-14}[shape]

    def load(self, scene: Scene) -> None:
        self._size_ratio = size_ratio(scene.bodies.sizes)
        self._tests = 0
        self._request = fcl.CollisionRequest()
        self._bodies = FclObjects(scene)
        self._count = len(scene.bodies)
        ignored = {(i, j) for i, j in scene.ignored.tolist()}
        # of all pairs, those that are asked about; no list where that is all
        self._asked = [pair not in ignored for pair in combinations(range(self._count), 2)] if ignored else None
        first, second = self._both_sides()
        self._listed = (list(first), list(second)) if self._count <= MOST_LISTED else None

    @property
    def counters(self) -> dict[str, float]:
        """Tests so far."""
        return {"pair_tests": self._tests, "narrow_tests": self._tests}

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        self._bodies.place(positions, quaternions)
        # A result is reused because making one costs as much as a far pair, but for one call only: it keeps every
        # contact it was ever given, and its own verdict, once true, stays so. What `collide` returns is the pair's.
        result = fcl.CollisionResult()
        verdicts = map(fcl.collide, *(self._listed or self._both_sides()), repeat(self._request), repeat(result))
        touching = list(compress(self._of_asked(combinations(range(self._count), 2)), verdicts))
        self._tests += self._count * (self._count - 1) // 2 if self._asked is None else sum(self._asked)
        return np.array(touching, np.int64).reshape(-1, 2)

    def _both_sides(self) -> tuple[Iterable[fcl.CollisionObject], Iterable[fcl.CollisionObject]]:
        """The first and the second object of every pair, in order."""
        objects = self._bodies.objects
        first = chain.from_iterable(map(repeat, objects, range(len(objects) - 1, -1, -1)))
        second = chain.from_iterable(objects[i:] for i in range(1, len(objects)))
        return self._of_asked(first), self._of_asked(second)

    def _of_asked(self, of_pairs: Iterable[T]) -> Iterable[T]:
        """What belongs to the pairs that are asked about, of one thing for each pair."""
        return of_pairs if self._asked is None else compress(of_pairs, self._asked)


BACKEND = Fcl
