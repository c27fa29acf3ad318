"""Rotations as scipy has them, of poses as this program has them.

In a file of its own since scipy takes as long to import as a server to start, and what asks whether pairs touch may do
without.
"""

from __future__ import annotations

from scipy.spatial.transform import Rotation

from harness.arrays import Floats, Ints
from harness.backends.poses import UniformMotion


def rotations(quaternions: Floats) -> Rotation:
    """Of (n, 4) unit quaternions w x y z."""
    return Rotation.from_quat(quaternions[:, [1, 2, 3, 0]])


def rotations_at(motion: UniformMotion, bodies: Ints, times: Floats) -> Rotation:
    """Of bodies (k,), each at a time (k,) s after the start."""
    return Rotation.from_rotvec(motion.spins[bodies] * times[:, None]) * rotations(motion.quaternions[bodies])
