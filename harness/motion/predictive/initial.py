"""What a caller gives: positions, velocities, radii and masses of spheres in a box, checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from harness.arrays import Floats
from harness.errors import InputError


@dataclass(frozen=True)
class InitialState:
    """Checked arrays of n spheres, SI units."""

    positions: Floats
    velocities: Floats
    radii: Floats
    masses: Floats
    half_box: Floats

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def packing(self) -> float:
        """Volume of the spheres to that of the box."""
        return float((self.radii**3).sum() * np.pi / 6.0 / np.prod(self.half_box))


def check(
    positions: ArrayLike, velocities: ArrayLike, radii: ArrayLike, masses: ArrayLike, half_box: ArrayLike
) -> InitialState:
    """The arrays in one shape and kind, or an InputError that says what is wrong with them."""
    radii_ = np.array(radii, dtype=np.float64, ndmin=1)
    n = len(radii_)
    start = InitialState(
        np.array(positions, dtype=np.float64).reshape(-1, 3) if n == 0 else np.array(positions, dtype=np.float64),
        np.array(velocities, dtype=np.float64).reshape(-1, 3) if n == 0 else np.array(velocities, dtype=np.float64),
        radii_,
        np.array(masses, dtype=np.float64, ndmin=1),
        np.array(half_box, dtype=np.float64),
    )
    shapes = {"positions": (n, 3), "velocities": (n, 3), "radii": (n,), "masses": (n,), "half_box": (3,)}
    for name, shape in shapes.items():
        array = getattr(start, name)
        if array.shape != shape:
            raise InputError(f"{name} must have the shape {shape}, not {array.shape}")
        if not np.isfinite(array).all():
            raise InputError(f"{name} must be finite")
    for name in ("radii", "masses", "half_box"):
        if (getattr(start, name) <= 0.0).any():
            raise InputError(f"{name} must be positive")
    return start
