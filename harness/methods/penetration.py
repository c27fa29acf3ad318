"""How deep touching bodies overlap, as a fraction of their mean size: an error of stepped motion, not a verdict."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from harness.arrays import Floats, Pairs
from harness.kernel import kernel, step
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

    def deepest(self, pairs: Pairs, positions: Floats, quaternions: Floats, known: float = 0.0) -> float:
        """Largest depth / mean size of these touching pairs, if it is more than is known; else what is known.

        Parameters
        ----------
        pairs : (k, 2) int array
        positions : (n, 3) float array, m
        quaternions : (n, 4) float array, w x y z
        known : of other frames; how deep less deep pairs are is not looked for
        """
        if self._hulls is None:
            return float(_deepest(pairs, positions, self._sizes, known))
        # bounding spheres bound the depth from above: hulls are asked in that order, until none can be deeper
        depths = _sphere_depths(pairs, positions, self._sizes)
        reaches = 0.5 * (self._sizes[pairs[:, 0]] + self._sizes[pairs[:, 1]])
        bounds = depths / reaches
        for k in np.argsort(-bounds):
            if not bounds[k] > known:
                break
            i, j = pairs[k].tolist()
            depth = min(float(depths[k]), self._hulls.depth(i, j, positions, quaternions))
            known = max(known, float(depth / reaches[k]))
        return known


class _HullDepth:
    """Depths of overlapping hulls by FCL's expanding polytope, on objects of its own."""

    def __init__(self, scene: Scene) -> None:
        import fcl  # only runs that measure hulls need it

        from harness.backends.fcl_objects import FclObjects

        self._distance = fcl.distance
        self._result = fcl.DistanceResult
        self._request = fcl.DistanceRequest(enable_signed_distance=True)
        self._bodies = FclObjects(scene)

    def depth(self, i: int, j: int, positions: Floats, quaternions: Floats) -> float:
        """m, of two bodies."""
        if np.array_equal(positions[i], positions[j]):
            return inf  # FCL may never return for concentric bodies; their spheres' depth stands
        for body in (i, j):
            self._bodies.place_one(body, positions[body], quaternions[body])
        first, second = self._bodies.objects[i], self._bodies.objects[j]
        return float(-self._distance(first, second, self._request, self._result()) * self._bodies.unit)


@kernel
def _sphere_depths(pairs: Pairs, positions: Floats, sizes: Floats) -> Floats:
    depths = np.empty(len(pairs))
    for k in range(len(pairs)):
        depths[k] = _sphere_depth(pairs[k, 0], pairs[k, 1], positions, sizes)
    return depths


@kernel
def _deepest(pairs: Pairs, positions: Floats, sizes: Floats, known: float) -> float:
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        known = max(known, _sphere_depth(i, j, positions, sizes) / (0.5 * (sizes[i] + sizes[j])))
    return known


@step
def _sphere_depth(i: int, j: int, positions: Floats, sizes: Floats) -> float:
    x, y, z = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1], positions[j, 2] - positions[i, 2]
    return float(0.5 * (sizes[i] + sizes[j]) - sqrt(x * x + y * y + z * z))
