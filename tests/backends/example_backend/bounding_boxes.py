"""A backend for harness from elsewhere: spheres, found by sorting their boxes along x.

`pip install .` in this folder makes it known as `engine: {backend: bounding-boxes, algorithm: native}`.
"""

import numpy as np


class BoundingBoxes:
    """Sweep along x, then the distance of the centres."""

    name = "bounding-boxes"
    shapes = ("sphere",)
    units = "as they come"
    precision = "double"

    def tolerance(self, shape):
        """Of size: verdicts on nearer contacts are not to be trusted."""
        return 1e-15

    def load(self, scene):
        """Called once, before anything is timed."""
        self.radii = scene.bodies.radii

    def pairs(self, positions, quaternions):
        """All touching pairs, i < j, sorted; positions (n, 3) in m, quaternions (n, 4) as w x y z."""
        start, end = positions[:, 0] - self.radii, positions[:, 0] + self.radii
        order = np.argsort(start, kind="stable")
        found = []
        for place, body in enumerate(order):
            last = np.searchsorted(start[order], end[body], side="right")
            others = order[place + 1 : last]
            apart = np.linalg.norm(positions[others] - positions[body], axis=1)
            found += [sorted((body, other)) for other in others[apart <= self.radii[others] + self.radii[body]]]
        return np.array(sorted(found), np.int64).reshape(-1, 2)
