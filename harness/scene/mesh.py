"""A mesh, normalised, with its convex hull."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.scene.hull import Hull

NO_HULL = "the mesh is flat, so that no hull encloses it; give it shape mesh"
Triangles: TypeAlias = NDArray[np.int32]
"""(f, 3), numbers of vertices."""


class Surface(NamedTuple):
    """Triangles: (v, 3) float array of vertices, (f, 3) int32 array of corners."""

    vertices: NDArray[np.float64]
    faces: Triangles


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle surface whose minimal bounding sphere has its centre at the origin and diameter 1.

    All arrays are C-contiguous and read-only: every body, backend and stage reads the same ones.

    Parameters
    ----------
    name : the file's name
    vertices : (v, 3) float array; every vertex is used by a face, no two are equal
    faces : (f, 3) int32 array, as many as the file has, in its order
    hull : Hull of the vertices
    digest : sha256 of the vertices and faces, hexadecimal
    watertight : every edge belongs to exactly two faces
    convex : the surface is its own hull, so that the hull may stand for it
    notes : what a person should know, such as "open: 3 boundary edges"
    diameter : of the minimal bounding sphere before it was normalised, in the file's unit
    flat : all of it lies in one plane, so that it encloses nothing; its hull is a polygon with two sides
    centre : of that sphere in the file, in its unit
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    hull: Hull
    digest: str
    watertight: bool
    convex: bool
    notes: tuple[str, ...] = ()
    diameter: float = 1.0
    flat: bool = False
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def identity(self) -> str:
        """By which two meshes are the same, as large and in the same place in their files, which poses may be of."""
        return f"{self.digest} {self.diameter!r} {self.centre!r}"


THIN = 2.0**-50
"""A face whose corners lie on a line up to this, of the largest coordinate, has no area: some roundings of it."""


def has_area(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Which faces have an area, (f,); `vertices` (v, 3) about the origin, in any unit.

    The readers of files leave the others out; a mesh made in memory may have some.
    """
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    twice_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.linalg.norm([b - a, c - b, a - c], axis=2).max(axis=0)
    return np.asarray(twice_area > THIN * np.abs(vertices).max() * longest)


def digest(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> str:
    """The sha256 by which two meshes are the same: of shapes and little-endian arrays, hexadecimal."""
    content = hashlib.sha256(f"{len(vertices)} {len(faces)}\n".encode())
    content.update(np.ascontiguousarray(vertices, "<f8").data)
    content.update(np.ascontiguousarray(faces, "<i4").data)
    return content.hexdigest()
