"""FCL's dynamic AABB tree over bounding spheres: which bodies are close enough to touch."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import fcl
import numpy as np
from numpy.typing import ArrayLike

from harness.arrays import Floats, Pairs
from harness.backends.fcl_objects import FclObjects
from harness.scene.scene import Scene


class FclTree:
    """Pairs whose bounding spheres touch, by FCL's dynamic tree of axis-aligned boxes.

    Parameters
    ----------
    scene : Scene
    radii : (n,) float array, m, of the spheres; without, those that hold the bodies

    Attributes
    ----------
    pair_tests : pairs put to the sphere test so far, those whose boxes overlap
    """

    def __init__(self, scene: Scene, radii: Floats | None = None) -> None:
        bodies = replace(scene.bodies, sizes=2 * (scene.enclosing_radii if radii is None else radii))
        spheres = Scene("sphere", (), bodies, scene.box)
        self.pair_tests = 0
        # The tree returns other objects than it was given. A contact names geometries, so that a body is identified by
        # its own; each therefore has a sphere of its own.
        self._bodies = FclObjects(spheres, shared=False)
        self._numbers = {id(geometry): body for body, geometry in enumerate(self._bodies.geometries)}
        self._request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=True)
        self._upright = scene.bodies.quaternions
        self._tree = fcl.DynamicAABBTreeCollisionManager()
        self._tree.registerObjects(self._bodies.objects)
        self._tree.setup()

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """Pairs of bodies whose bounding spheres touch.

        Parameters
        ----------
        positions : (n, 3) float array, m

        Returns
        -------
        (k, 2) int array
            i < j, sorted.
        """
        self._bodies.place(np.asarray(positions, np.float64), self._upright)
        self._tree.update()
        request, result, tests = self._request, fcl.CollisionResult(), 0

        def test(first: Any, second: Any, _: None) -> bool:
            nonlocal tests
            tests += 1
            fcl.collide(first, second, request, result)
            return False  # go on

        self._tree.collide(None, test)
        self.pair_tests += tests
        numbers = self._numbers
        close = sorted(sorted((numbers[id(found.o1)], numbers[id(found.o2)])) for found in result.contacts)
        return np.array(close, np.int64).reshape(-1, 2)
