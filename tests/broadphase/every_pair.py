"""The definition of close pairs in numpy, without any of the code under test."""

import numpy as np


def touching_pairs(positions, radii):
    """(k, 2) int array, i < j, sorted: pairs of spheres whose distance, not its square, is at most the sum of radii."""
    dx, dy, dz = (positions[:, None] - positions[None]).transpose(2, 0, 1)
    reach = radii[:, None] + radii[None]
    return np.argwhere(np.triu(np.sqrt(dx * dx + dy * dy + dz * dz) <= reach, 1)).reshape(-1, 2)
