"""The closed box the bodies fly in, centred at the origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Box:
    """An axis-aligned box.

    >>> Box([2.0, 2.0, 1.0]).volume
    32.0

    Parameters
    ----------
    half : (3,) float array, m; half the sides, read-only
    """

    half: NDArray[np.float64]

    def __post_init__(self) -> None:
        half = np.array(self.half, np.float64)
        if half.shape != (3,) or not (np.isfinite(half) & (half > 0)).all():
            raise ValueError(f"a box needs three positive finite half sides, not {self.half}")
        half.setflags(write=False)
        object.__setattr__(self, "half", half)

    @property
    def sides(self) -> NDArray[np.float64]:
        """(3,) float array, m."""
        return 2 * self.half

    @property
    def volume(self) -> float:
        """m³."""
        return float(np.prod(self.sides))
