"""FCL asked about single pairs: those that a method has left, at the poses of a frame."""

from __future__ import annotations

import fcl
import numpy as np

from harness.arrays import Flags, Floats, Pairs
from harness.backends.fcl_objects import FclObjects
from harness.scene.scene import Scene


class FclPairTest:
    """Puts pairs to FCL, moving only the bodies in them.

    Parameters
    ----------
    scene : Scene

    Attributes
    ----------
    tests : pairs that FCL was asked about so far
    """

    def __init__(self, scene: Scene) -> None:
        self.tests = 0
        self._bodies = FclObjects(scene)
        self._request = fcl.CollisionRequest()

    def verdicts(self, pairs: Pairs, positions: Floats, quaternions: Floats) -> Flags:
        """Which pairs touch.

        Parameters
        ----------
        pairs : (k, 2) int array
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, unit, w x y z

        Returns
        -------
        (k,) bool array
        """
        self.tests += len(pairs)
        self._bodies.place(positions, quaternions, np.unique(pairs))
        objects, request = self._bodies.objects, self._request
        # A result is reused because making one costs as much as a far pair, but for one frame only: it keeps every
        # contact it was ever given, and its own verdict, once true, stays so. What `collide` returns is the pair's.
        result = fcl.CollisionResult()
        verdicts = [fcl.collide(objects[i], objects[j], request, result) for i, j in pairs.tolist()]
        return np.array(verdicts, np.bool_)
