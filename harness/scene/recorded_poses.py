"""Poses that some other program has recorded: where every body was, at one time after another."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.scene.bodies import Bodies

Floats = NDArray[np.float64]


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
        """The poses of points of the bodies, such as the centres of their bounding spheres.

        Parameters
        ----------
        offsets : (n, 3) float array, m, where they are in the frames that the poses are of
        """
        return RecordedPoses(
            self.name,
            self.time,
            self.positions + _turned(self.quaternions, np.broadcast_to(offsets, self.positions.shape)),
            self.quaternions,
            self.digest,
        )

    def at(self, frame: int, sizes: Floats) -> Bodies:
        """The bodies at one of the times, with the motion that takes them to the next: constant velocity and spin.

        Parameters
        ----------
        frame : which time, from 0; at the last one the bodies are at rest
        sizes : (n,) float array, m
        """
        velocities, spins = np.zeros((2, self.bodies, 3))
        if frame + 1 < len(self):
            duration = self.time[frame + 1] - self.time[frame]
            velocities = (self.positions[frame + 1] - self.positions[frame]) / duration
            spins = rotation_vectors(self.quaternions[frame], self.quaternions[frame + 1]) / duration
        return Bodies(self.positions[frame], velocities, self.quaternions[frame], spins, sizes, sizes**3)


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
