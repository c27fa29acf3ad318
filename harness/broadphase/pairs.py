"""Which pairs are asked for, and what every broad phase has in common.

Two bodies are close when their bounding spheres touch. Every method decides that with `touching`, to the bit the same
arithmetic, so that all of them return the same pairs and not merely nearly the same. Which of the two bodies comes
first makes no difference to it.
"""

from math import sqrt
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.arrays import Floats, Pairs
from harness.kernel import kernel
from harness.threads import Threads

Keys = NDArray[np.int64]  # (k,) i << 32 | j of pairs

# Squares of radii, and of distances as small, must neither overflow nor vanish.
SMALLEST, LARGEST = 1e-150, 1e150

NO_PLACES = "positions must be finite, and within 1e150 m"

NEARLY = 1.0 + 1e-6
"""Spheres whose distance squared exceeds their reach squared by this factor do not touch, whatever is rounded."""


class BroadPhase(Protocol):
    """A method that finds close pairs, frame after frame, of the same bodies.

    Attributes
    ----------
    pair_tests : int
        Pairs put to the sphere test so far, over all frames.
    """

    pair_tests: int

    def close_pairs(self, positions: ArrayLike) -> Pairs:
        """Pairs of bodies whose bounding spheres touch.

        Parameters
        ----------
        positions : (n, 3) array, m

        Returns
        -------
        (k, 2) int array
            Indices i < j, sorted. Exactly the pairs that `touching` accepts: |x_i - x_j| <= r_i + r_j.

        Raises
        ------
        ValueError
            If the shape is wrong, or a coordinate is not a finite number within 1e150 m.
        """
        ...


@runtime_checkable
class Shareable(Protocol):
    """A broad phase whose bodies several threads can share out."""

    def share_with(self, threads: Threads) -> None:
        """Share them out from now on; pairs, their order and what is counted stay the same."""

    def compile_shared(self) -> None:
        """Compile what that needs, outside of every clock."""


@kernel
def touching(dx: float, dy: float, dz: float, reach: float) -> bool:
    """Whether spheres touch whose centres are (dx, dy, dz) apart, m, and whose radii sum to `reach`, m.

    The distance itself is compared, not its square: FCL does so, and agrees to the bit.
    """
    return sqrt(dx * dx + dy * dy + dz * dz) <= reach


@kernel
def require_finite(positions: Floats) -> None:
    """Refuse positions, m, that are NaN or infinite, or whose squares would be."""
    refused = 0
    for i in range(len(positions)):
        for axis in range(3):
            refused += not abs(positions[i, axis]) <= LARGEST
    if refused > 0:
        raise ValueError(NO_PLACES)


def checked_radii(radii: ArrayLike) -> Floats:
    """Radii, m, as the kernels want them: a contiguous copy, every one positive and finite."""
    checked = np.array(radii, dtype=np.float64, order="C")
    if checked.ndim != 1:
        raise ValueError(f"radii must have the shape (n,), not {checked.shape}")
    if not np.all((checked >= SMALLEST) & (checked <= LARGEST)):
        raise ValueError(f"radii must lie between {SMALLEST:g} and {LARGEST:g} m")
    return checked


def checked_positions(positions: ArrayLike, count: int) -> Floats:
    """Positions, m, as the kernels want them; copied only if they are not."""
    checked = np.ascontiguousarray(positions, dtype=np.float64)
    if not checked.flags.writeable:  # another type to numba, which would compile everything once more
        checked = checked.copy()
    if checked.shape != (count, 3):
        raise ValueError(f"positions must have the shape ({count}, 3), not {checked.shape}")
    return checked


@kernel
def unpack(keys: Keys) -> Pairs:
    """(k, 2) int array of i and j from i << 32 | j."""
    pairs = np.empty((len(keys), 2), np.int64)
    for k in range(len(keys)):
        pairs[k, 0] = keys[k] >> 32
        pairs[k, 1] = keys[k] & 0xFFFFFFFF
    return pairs
