"""Where the bodies of a frame are, with matrices only for those that some pair asks for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Flags, Floats
from harness.kernel import strict_step
from harness.narrowphase.gjk import Relative, relative_pose
from harness.narrowphase.units import unit_of
from harness.narrowphase.vectors import Matrix, Vector, minus, rotation, scaled


class Placement(NamedTuple):
    """Poses of n bodies.

    Attributes
    ----------
    positions : (n, 3) float array, m
    quaternions : (n, 4) float array, unit, w x y z
    sizes : (n,) float array, in units
    scale : units a metre, a power of two
    rotations : (n, 3, 3) float array, written when a body is first asked for
    turned : (n,) bool array, which bodies have their matrix
    """

    positions: Floats
    quaternions: Floats
    sizes: Floats
    scale: float
    rotations: Floats
    turned: Flags


class Places:
    """The placements of the same bodies, frame after frame, in the same arrays.

    Parameters
    ----------
    sizes : (n,) float array, m
    """

    def __init__(self, sizes: Floats) -> None:
        unit = unit_of(sizes)
        self._sizes, self._scale = sizes / unit, 1.0 / unit
        self._rotations, self._turned = np.empty((len(sizes), 3, 3)), np.empty(len(sizes), np.bool_)

    def at(self, positions: Floats, quaternions: Floats) -> Placement:
        """The placement at these poses: positions (n, 3) in m, quaternions (n, 4); it forgets the one before."""
        self._turned[:] = False
        return Placement(positions, quaternions, self._sizes, self._scale, self._rotations, self._turned)


@strict_step
def rotation_of(placement: Placement, body: int) -> Matrix:
    """The body's matrix, made when it is first asked for.

    Raises
    ------
    ValueError
        If its quaternion is not finite, or far from a unit quaternion.
    """
    q, r = placement.quaternions, placement.rotations
    if not placement.turned[body]:
        w, x, y, z = q[body, 0], q[body, 1], q[body, 2], q[body, 3]
        if not abs(w * w + x * x + y * y + z * z - 1.0) < 1e-6:
            raise ValueError("an orientation is not a unit quaternion, or not finite")
        matrix = rotation(w, x, y, z)
        for column in range(3):
            r[body, 0, column] = matrix[0][column]
            r[body, 1, column] = matrix[1][column]
            r[body, 2, column] = matrix[2][column]
        placement.turned[body] = True
    return (
        (r[body, 0, 0], r[body, 0, 1], r[body, 0, 2]),
        (r[body, 1, 0], r[body, 1, 1], r[body, 1, 2]),
        (r[body, 2, 0], r[body, 2, 1], r[body, 2, 2]),
    )


@strict_step
def offset_of(placement: Placement, i: int, j: int) -> Vector:
    """From the centre of body i to that of j, in units."""
    x = placement.positions
    return scaled(minus((x[j, 0], x[j, 1], x[j, 2]), (x[i, 0], x[i, 1], x[i, 2])), placement.scale)


@strict_step
def pose_of(placement: Placement, i: int, j: int) -> Relative:
    """Body j as seen from body i."""
    offset = offset_of(placement, i, j)
    size_i, size_j = placement.sizes[i], placement.sizes[j]
    return relative_pose(rotation_of(placement, i), size_i, rotation_of(placement, j), size_j, offset)
