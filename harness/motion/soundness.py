"""No result is kept of a motion that has lost its numbers."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats


class NotANumberError(Exception):
    """Something that must be a finite number is none."""


def refuse_lost(positions: Floats, velocities: Floats, time: float) -> None:
    """Raise unless every place and velocity, (n, 3) m and m/s at `time` (s), is finite.

    Comparisons with what is not a number are false, so that nothing else of a run might notice.

    Raises
    ------
    NotANumberError
    """
    for name, array in (("position", positions), ("velocity", velocities)):
        lost = np.flatnonzero(~np.isfinite(array).all(axis=1))
        if len(lost):
            more = f", and of {len(lost) - 1} more" if len(lost) > 1 else ""
            raise NotANumberError(f"at {time:g} s the {name} of body {lost[0]}{more} is not a finite number")
