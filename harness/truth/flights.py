"""Pairs of bodies in free flight: what a case of the set states, in arrays of many cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from harness.arrays import Floats, Ints


class Flights(NamedTuple):
    """How the first, or the second, bodies of n cases move.

    A point p of the mesh is at x + v t + exp(w t) (q / |q|) (s p) at the time t: all numbers as they stand, as real
    numbers.

    Attributes
    ----------
    meshes : (n,) int array, which mesh
    sizes : (n,) float array, m, factors s on the vertices
    positions : (n, 3) float array, m, x
    quaternions : (n, 4) float array, w x y z, of any length but 0, q
    velocities : (n, 3) float array, m/s, v
    spins : (n, 3) float array, rad/s, in the world, w
    """

    meshes: Ints
    sizes: Floats
    positions: Floats
    quaternions: Floats
    velocities: Floats
    spins: Floats

    def some(self, rows: Ints) -> Flights:
        """Those of some of the cases."""
        columns: list[Any] = [column[rows] for column in self]
        return Flights(*columns)


def stacked(flights: Sequence[Flights]) -> Flights:
    """The flights of several lists of cases, one behind the other."""
    return Flights(*(np.concatenate(column) for column in zip(*flights, strict=True)))
