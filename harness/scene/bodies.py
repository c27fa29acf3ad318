"""Bodies as arrays: one row a body."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray


@dataclass(eq=False)
class Bodies:
    """Where the bodies are and how they move at one moment.

    Parameters
    ----------
    positions : (n, 3) float array, m; centres of the bounding spheres
    velocities : (n, 3) float array, m/s
    quaternions : (n, 4) float array, unit, w x y z; rotate the mesh's axes to the world's
    spins : (n, 3) float array, rad/s, world frame
    sizes : (n,) float array, m; diameters of the bounding spheres
    masses : (n,) float array, kg
    """

    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    quaternions: NDArray[np.float64]
    spins: NDArray[np.float64]
    sizes: NDArray[np.float64]
    masses: NDArray[np.float64]

    def __post_init__(self) -> None:
        count = len(self.positions)
        shapes = {"positions": (3,), "velocities": (3,), "quaternions": (4,), "spins": (3,), "sizes": (), "masses": ()}
        for name, shape in shapes.items():
            array = np.ascontiguousarray(getattr(self, name), np.float64)
            if array.shape != (count, *shape):
                raise ValueError(f"{name} of {count} bodies must have shape {(count, *shape)}, not {array.shape}")
            setattr(self, name, array)

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def radii(self) -> NDArray[np.float64]:
        """(n,) float array, m: radii of the bounding spheres."""
        return self.sizes / 2

    def copy(self) -> Bodies:
        """The same bodies in arrays of their own."""
        return Bodies(*(getattr(self, field.name).copy() for field in fields(self)))
