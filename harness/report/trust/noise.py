"""Times as a shared machine has them: drift, processes that differ, heavy tails, and short runs that are noisier."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Times = npt.NDArray[np.float64]


@dataclass(frozen=True)
class MachineNoise:
    """What multiplies the true time of a run.

    Parameters
    ----------
    drift : standard deviation of the logarithm of what a whole repeat has in common
    run : scale of the logarithm of a run's own noise, Student's with three degrees of freedom, of the longest runs
    short : how many times that scale is for the shortest
    slow_process, slow_by : share of processes that run slower throughout, and by how much, relatively
    hiccup, hiccup_by : the same, of runs that something else disturbed
    """

    drift: float = 0.1
    run: float = 0.02
    short: float = 4.0
    slow_process: float = 0.25
    slow_by: float = 0.03
    hiccup: float = 0.05
    hiccup_by: float = 0.3

    def factors(self, rng: np.random.Generator, repeats: int, lengths: npt.ArrayLike) -> Times:
        """(repeats, k) factors of k runs in each of these repeats.

        Parameters
        ----------
        lengths : (k,) how long each run is, of the longest: from 0 to 1
        """
        share = np.asarray(lengths, dtype=float)
        shape = (repeats, len(share))
        own = rng.standard_t(3, shape) * self.run * self.short ** (1.0 - share)
        slow = np.where(rng.random(shape) < self.slow_process, self.slow_by, 0.0)
        hiccups = np.where(rng.random(shape) < self.hiccup, self.hiccup_by, 0.0)
        factors: Times = np.exp(rng.normal(0.0, self.drift, (repeats, 1)) + own) * (1.0 + slow) * (1.0 + hiccups)
        return factors
