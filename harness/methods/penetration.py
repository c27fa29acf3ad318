"""How deep touching bodies overlap, as a fraction of their mean size: an error of stepped motion, not a verdict."""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.arrays import Floats, Pairs
from harness.kernel import kernel
from harness.scene.scene import Scene


class Penetration:
    """Measures the deepest overlap among touching pairs of spheres or hulls.

    Parameters
    ----------
    scene : Scene
        Of shape `sphere` or `hull`.
    """

    def __init__(self, scene: Scene) -> None:
        self._sizes = scene.bodies.sizes
        self._hulls = _HullDepth(scene) if scene.shape == "hull" else None

    def deepest(self, pairs: Pairs, positions: Floats, quaternions: Floats) -> float:
        """Largest depth / mean size of these touching pairs; 0 without pairs.

        Parameters
        ----------
        pairs : (k, 2) int array
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, w x y z
        """
        if not len(pairs):
            return 0.0
        depths = _NO_DEPTHS if self._hulls is None else self._hulls.depths(pairs, positions, quaternions)
        return float(_deepest(pairs, positions, self._sizes, depths))


class _HullDepth:
    """Depths of overlapping hulls by FCL's expanding polytope, on objects of its own."""

    def __init__(self, scene: Scene) -> None:
        import fcl  # only runs that measure hulls need it

        from harness.backends.fcl_objects import FclObjects

        self._distance = fcl.distance
        self._result = fcl.DistanceResult
        self._request = fcl.DistanceRequest(enable_signed_distance=True)
        self._bodies = FclObjects(scene)

    def depths(self, pairs: Pairs, positions: Floats, quaternions: Floats) -> Floats:
        depths = np.full(len(pairs), np.inf)
        for k, (i, j) in enumerate(pairs.tolist()):
            if np.array_equal(positions[i], positions[j]):
                continue  # FCL may never return for concentric bodies; their spheres' depth stands
            for body in (i, j):
                self._bodies.place_one(body, positions[body], quaternions[body])
            first, second = self._bodies.objects[i], self._bodies.objects[j]
            depths[k] = -self._distance(first, second, self._request, self._result()) * self._bodies.unit
        return depths


_NO_DEPTHS: Floats = np.empty(0)


@kernel
def _deepest(pairs: Pairs, positions: Floats, sizes: Floats, depths: Floats) -> float:
    """Largest depth / mean size, or 0; without depths (k,) in m those of the bounding spheres."""
    deepest = 0.0
    for k in range(len(pairs)):
        i, j = pairs[k]
        x, y, z = positions[j] - positions[i]
        reach = 0.5 * (sizes[i] + sizes[j])
        depth = reach - sqrt(x * x + y * y + z * z)
        if len(depths):
            # bounding spheres bound the depth from above, whatever the hull's own answer is
            depth = min(depth, depths[k])
        deepest = max(deepest, depth / reach)
    return deepest
