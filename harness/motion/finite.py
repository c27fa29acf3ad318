"""A motion whose positions or velocities are not finite gives no result."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats


class NotFiniteError(Exception):
    """A number that must be finite is not."""


def require_finite_state(positions: Floats, velocities: Floats, time: float) -> None:
    """Raise unless every place and velocity, (n, 3) m and m/s at `time` (s), is finite.

    Comparisons with NaN are false, so that no other check of a run might notice.

    Raises
    ------
    NotFiniteError
    """
    for name, array in (("position", positions), ("velocity", velocities)):
        wrong = np.flatnonzero(~np.isfinite(array).all(axis=1))
        if len(wrong):
            more = f", and of {len(wrong) - 1} more" if len(wrong) > 1 else ""
            raise NotFiniteError(f"at {time:g} s the {name} of body {wrong[0]}{more} is not a finite number")
