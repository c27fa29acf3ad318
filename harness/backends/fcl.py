"""FCL through python-fcl: exact spheres, hulls and meshes. Which pairs it is asked about is up to the algorithm."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import chain, combinations, compress, repeat
from typing import Literal

import fcl
import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.detection import decide_detection
from harness.backends.stages import Decisions
from harness.broadphase.grid import Grid
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.narrowphase.fcl_objects import FclObjects
from harness.narrowphase.fcl_tree import FclTree
from harness.narrowphase.judges import FclJudge, HullJudge, Judge, MeshJudge
from harness.narrowphase.units import UNITS
from harness.scene.scene import Scene
from harness.vocabulary import Shape

Algorithm = Literal["brute-force", "grid", "tree"]

# Up to so many bodies brute force keeps its pairs in lists (8 MB), which saves a tenth of its time.
MOST_LISTED = 1000


class Fcl:
    """Every pair, or only those whose bounding spheres touch, put to FCL.

    Parameters
    ----------
    algorithm : {"brute-force", "grid", "tree"}
        `brute-force` puts every pair to FCL at every call. `grid` and `tree` first find the pairs whose bounding
        spheres touch; for spheres that is the answer. `tree` puts them to FCL, `grid` only those that it cannot settle
        by the hulls and by a search for crossing triangles: hulls nearer to touching than rounding can tell, meshes
        not proved to touch.

    Attributes
    ----------
    stages : stages of detection (`harness.backends.detection`) forced on or off, set before loading; without, a scene
        gets what it needs. The answer is the same.
    """

    name = "fcl"
    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")
    units = UNITS
    precision = "double"

    def __init__(self, algorithm: Algorithm = "brute-force") -> None:
        self.stages: Mapping[str, bool] = {}
        self._algorithm = algorithm
        self._request = fcl.CollisionRequest()

    def tolerance(self, shape: Shape) -> float:
        """Measured against exact rationals; the rare worst case for hulls."""
        return {"sphere": 1e-15, "hull": 1e-11, "mesh": 1e-14}[shape]

    def load(self, scene: Scene) -> None:
        self._tests = 0
        self._broad: Grid | FclTree | None = None
        self._judge: Judge | None = None
        if self._algorithm == "brute-force":
            self._bodies = FclObjects(scene)
            self._find: Callable[[Floats, Floats], Pairs] = self._brute_force
            few = len(scene.bodies) <= MOST_LISTED
            first, second = self._both_sides()
            self._listed = (list(first), list(second)) if few else None
            return
        decisions = Decisions(self.stages)
        decide_detection(scene, self._algorithm, decisions)
        decisions.check()
        kept = {stage.name: stage.kept for stage in decisions.stages}
        if self._algorithm == "tree":
            self._broad = FclTree(scene)
        else:
            self._broad = (HierarchicalGrid if kept["size_classes"] else Grid)(scene.bodies.radii, scene.box)
        if scene.shape == "sphere":
            self._find = partial(self._spheres, self._broad)
            return
        if not kept["hull_axis"]:
            self._judge = FclJudge(scene)
        elif scene.shape == "hull":
            self._judge = HullJudge(scene)
        else:
            self._judge = MeshJudge(scene, crossing=kept["crossing"], containment=kept["containment"])
        self._find = partial(self._culled, self._broad, self._judge)

    @property
    def counters(self) -> dict[str, float]:
        """Tests so far, and with the grid how many of its cells a body's bounding cube overlapped in the last call."""
        if self._broad is None:
            return {"pair_tests": self._tests, "narrow_tests": self._tests}
        tests = self._broad.pair_tests
        counted: dict[str, float] = {"pair_tests": tests}
        counted |= self._judge.counters if self._judge else {"narrow_tests": tests}
        if isinstance(self._broad, Grid):
            counted["cells_per_body_most"], counted["cells_per_body"] = self._broad.cells_per_body()
        return counted

    @property
    def contained(self) -> Pairs:
        """(k, 2) int array: pairs of the last frame of which one mesh is wholly inside the other, where `grid` looks
        for them. Their surfaces do not touch, so that they are no hits."""
        found: Pairs = getattr(self._judge, "contained", np.empty((0, 2), np.int64))
        return found

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        return self._find(positions, quaternions)

    def _brute_force(self, positions: Floats, quaternions: Floats) -> Pairs:
        self._bodies.place(positions, quaternions)
        count = len(positions)
        # A result is reused because making one costs as much as a far pair, but for one call only: it keeps every
        # contact it was ever given, and its own verdict is sticky. What `collide` returns is the pair's verdict.
        result = fcl.CollisionResult()
        verdicts = map(fcl.collide, *(self._listed or self._both_sides()), repeat(self._request), repeat(result))
        touching = list(compress(combinations(range(count), 2), verdicts))
        self._tests += count * (count - 1) // 2
        return np.array(touching, np.int64).reshape(-1, 2)

    def _both_sides(self) -> tuple[Iterable[fcl.CollisionObject], Iterable[fcl.CollisionObject]]:
        """The first and the second object of every pair, in order."""
        objects = self._bodies.objects
        first = chain.from_iterable(map(repeat, objects, range(len(objects) - 1, -1, -1)))
        return first, chain.from_iterable(objects[i:] for i in range(1, len(objects)))

    def _spheres(self, broad: Grid | FclTree, positions: Floats, quaternions: Floats) -> Pairs:
        return broad.close_pairs(positions)

    def _culled(self, broad: Grid | FclTree, judge: Judge, positions: Floats, quaternions: Floats) -> Pairs:
        return judge.touching(broad.close_pairs(positions), positions, quaternions)
