"""Poses that some other program has recorded: where every body was, at one time after another."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from harness.arrays import Floats
from harness.scene.bodies import Bodies


@dataclass(frozen=True, eq=False)
class RecordedPoses:
    """Poses of n bodies at f times; all arrays are C-contiguous and read-only.

    Parameters
    ----------
    name : of the file
    time : (f,) float array, s, growing
    positions : (f, n, 3) float array, m
    quaternions : (f, n, 4) float array, unit, w x y z
    digest : sha256 of the arrays, hexadecimal
    """

    name: str
    time: Floats
    positions: Floats
    quaternions: Floats
    digest: str

    @property
    def identity(self) -> str:
        """By which two recordings are the same."""
        return self.digest

    def __len__(self) -> int:
        """How many times there are."""
        return len(self.time)

    @property
    def bodies(self) -> int:
        """How many bodies there are."""
        return int(self.positions.shape[1])

    def of_centres(self, offsets: Floats) -> RecordedPoses:
        """The poses of points of the bodies, such as the centres of their bounding spheres, from time 0 on.

        Parameters
        ----------
        offsets : (n, 3) float array, m, where they are in the frames that the poses are of
        """
        return RecordedPoses(
            self.name,
            self.time - self.time[0],
            self.positions + _turned(self.quaternions, np.broadcast_to(offsets, self.positions.shape)),
            self.quaternions,
            self.digest,
        )

    def motion(self, frame: int) -> tuple[Floats, Floats]:
        """The velocities (n, 3) m/s and spins (n, 3) rad/s that take the bodies from one time to the next.

        Both are constant on the way. The turn is the shorter one; after the last time bodies are at rest.
        """
        if frame + 1 >= len(self):
            velocities, spins = np.zeros((2, self.bodies, 3))
            return velocities, spins
        duration = self.time[frame + 1] - self.time[frame]
        velocities = (self.positions[frame + 1] - self.positions[frame]) / duration
        return velocities, rotation_vectors(self.quaternions[frame], self.quaternions[frame + 1]) / duration

    def at_start(self, sizes: Floats, masses: Floats) -> Bodies:
        """The bodies at the first time; sizes (n,) m, masses (n,) kg."""
        velocities, spins = self.motion(0)
        return Bodies(self.positions[0], velocities, self.quaternions[0], spins, sizes, masses)

    @property
    def farthest_moves(self) -> Floats:
        """(n,) m: the farthest that each body moves from one time to the next."""
        ways: Floats = np.linalg.norm(np.diff(self.positions, axis=0), axis=2).max(axis=0)
        return ways

    def half_box(self, radii: Floats) -> Floats:
        """(3,) m: half the sides of a box about the origin that holds spheres around the bodies at all times."""
        half: Floats = (np.abs(self.positions) + radii[:, None]).max(axis=(0, 1))
        return half


def digest_of(time: Floats, positions: Floats, quaternions: Floats) -> str:
    """The sha256 by which two recordings are the same: of shapes and little-endian arrays, hexadecimal."""
    content = hashlib.sha256(f"{positions.shape}\n".encode())
    for array in (time, positions, quaternions):
        content.update(np.ascontiguousarray(array, "<f8").tobytes())
    return content.hexdigest()


def rotation_vectors(start: Floats, end: Floats) -> Floats:
    """The shortest turns from one orientation to another, in the world: axis times angle, rad.

    Parameters
    ----------
    start, end : (n, 4) float arrays, unit, w x y z

    >>> half = np.sqrt(0.5)
    >>> rotation_vectors(np.array([[1.0, 0, 0, 0]]), np.array([[half, 0, 0, half]])).round(12).tolist()
    [[0.0, 0.0, 1.570796326795]]
    """
    w0, v0, w1, v1 = start[:, :1], start[:, 1:], end[:, :1], end[:, 1:]
    # end * conjugate(start)
    w = w0 * w1 + (v0 * v1).sum(axis=1, keepdims=True)
    v = w0 * v1 - w1 * v0 - np.cross(v1, v0)
    v, w = np.where(w < 0.0, -v, v), np.abs(w)  # both signs are the same rotation
    length = np.linalg.norm(v, axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(length, w)
    vectors: Floats = v * np.where(length > 0.0, angle / np.where(length > 0.0, length, 1.0), 0.0)
    return vectors


def _turned(quaternions: Floats, vectors: Floats) -> Floats:
    """(…, 3): vectors, each turned by its quaternion."""
    w, axes = quaternions[..., :1], quaternions[..., 1:]
    across = 2.0 * np.cross(axes, vectors)
    turned: Floats = vectors + w * across + np.cross(axes, across)
    return turned
