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
        """Those of a run."""
        return cls(trace.times, trace.bodies, trace.walls)

    def in_one_layout(self) -> Events:
        """The same in plain arrays, wherever they come from.

        A kernel is compiled anew for parts of records, and for what may not be written to.
        """
        return Events(
            np.require(self.times, requirements=["C", "W"]),
            np.require(self.bodies, requirements=["C", "W"]),
            np.require(self.walls, requirements=["C", "W"]),
        )
