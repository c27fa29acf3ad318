"""FCL through python-fcl: exact spheres, hulls and meshes, every pair put to it."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain, combinations, compress, repeat
from typing import TYPE_CHECKING, TypeVar

import fcl
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.fcl_objects import UNITS, FclObjects
from harness.backends.fcl_tree import FclTree
from harness.backends.poses import UniformMotion, impact_times, near_pairs, near_radii, require_finite
from harness.backends.protocol import ImpactTimes, NearPairs
from harness.scene.scene import Scene
from harness.vocabulary import Query, Shape

if TYPE_CHECKING:
    from harness.backends.fcl_pair_gaps import FclPairGaps

# Up to so many bodies the pairs are kept in lists (8 MB), which saves a tenth of the time.
MOST_LISTED = 1000

T = TypeVar("T")


class Fcl:
    """Whether pairs touch: every pair, every frame. Methods of this program ask it of single pairs: see `FclPairTest`.

    How far apart pairs are, and when they meet, it is asked of those that its own tree of bounding spheres leaves,
    grown by what is asked for; the tree's own distance query tells of the nearest pair alone.
    """

    name = "fcl"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    queries: tuple[Query, ...] = ("collision", "tolerance", "distance", "impact")
    units = UNITS
    precision = "double"

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals, the rare worst case for hulls; of sizes that differ 10^4 times 1e-13."""
        return {"sphere": 1e-15, "hull": 1e-11, "mesh": 1e-14}[shape]

    def load(self, scene: Scene) -> None:
        self._tests = 0
        self._request = fcl.CollisionRequest()
        self._scene = scene
        self._tree: FclTree | None = None
        self._tree_radii = scene.enclosing_radii
        self._pair_gaps: FclPairGaps | None = None
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

    def distances(self, positions: Floats, quaternions: Floats, within: float) -> NearPairs:
        require_finite(positions, quaternions)
        pairs = self._close_pairs(positions, near_radii(self._scene.enclosing_radii, within))
        self._tests += len(pairs)
        return near_pairs(pairs, *self._single.gaps(pairs, positions, quaternions), within)

    def impacts(
        self, positions: Floats, quaternions: Floats, velocities: Floats, spins: Floats, duration: float
    ) -> ImpactTimes:
        """Late or early, and of meshes often wrong: what was measured stands at `FclPairGaps.impacts`."""
        require_finite(positions, quaternions, velocities, spins)
        motion = UniformMotion(positions, quaternions, velocities, spins, duration)
        pairs = self._close_pairs(motion.middle(), motion.swept_radii(self._scene.enclosing_radii))
        self._tests += len(pairs)
        return impact_times(self._single.impacts(pairs, motion), duration)

    @property
    def _single(self) -> FclPairGaps:
        """What asks about single pairs; made when it is first needed, since it builds every mesh once more."""
        if self._pair_gaps is None:
            from harness.backends.fcl_pair_gaps import FclPairGaps  # which imports scipy

            self._pair_gaps = FclPairGaps(self._scene)
        return self._pair_gaps

    def _close_pairs(self, centres: Floats, radii: Floats) -> Pairs:
        """Pairs of spheres that touch, by FCL's tree, which is made anew when the radii change."""
        if self._tree is None or not np.array_equal(radii, self._tree_radii):
            self._tree, self._tree_radii = FclTree(self._scene, radii), radii
        return self._tree.close_pairs(centres)

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
