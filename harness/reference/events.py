"""The events of a run as arrays that kernels take: who met whom or which wall, and when."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.motion.hits import Trace


class Events(NamedTuple):
    """Pair and wall hits in the order in which they were answered.

    Parameters
    ----------
    times : (k,) float array, s
    bodies : (k, 2) int array; the second is -1 where a wall was hit
    walls : (k,) int array, number in `WALLS`, -1 where two bodies met
    """

    times: Floats
    bodies: Pairs
    walls: Ints

    @classmethod
    def of(cls, trace: Trace) -> Events:
        """Those of a run, in arrays of one layout whatever the run keeps them in: kernels are compiled for each."""
        return cls(
            np.ascontiguousarray(trace.times), np.ascontiguousarray(trace.bodies), np.ascontiguousarray(trace.walls)
        )
