"""What a mesh file holds: vertices, and polygons of any number of corners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

MAX_FACES = 2_000_000
MAX_VERTICES = 3 * MAX_FACES  # as many as STL writes


@dataclass(frozen=True, eq=False)
class PolygonMesh:
    """Polygons as a file has them, not yet checked.

    Parameters
    ----------
    vertices : (v, 3) float array
    corners : (c,) int array, the vertices of all polygons one after another, counted from 0
    lengths : (p,) int array, how many corners each polygon has
    base : from which number the file counts its vertices
    vertex_line, face_line : the line of the file in which a vertex or a polygon stands; None for a binary file
    notes : what a person should know of how the file was read
    """

    vertices: NDArray[np.float64]
    corners: NDArray[np.int64]
    lengths: NDArray[np.int64]
    base: int = 0
    vertex_line: Callable[[int], int] | None = None
    face_line: Callable[[int], int] | None = None
    notes: tuple[str, ...] = ()


def of_triangles(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> PolygonMesh:
    """Triangles, (f, 3) int array, as polygons."""
    return PolygonMesh(vertices, faces.reshape(-1).astype(np.int64), np.full(len(faces), 3, np.int64))


def scaled(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vertices times the power of two that brings the largest coordinate near 1.

    No digit changes, and products of coordinates stay within the range of numbers.
    """
    _, exponent = np.frexp(np.abs(vertices).max(initial=0.0))
    return np.asarray(np.ldexp(vertices, -exponent))


def beyond(count: int, unit: str, faces: int) -> tuple[str, ...]:
    """The note of a file that goes on behind the faces that it announces: either is wrong, its end or their number.

    >>> beyond(600, "byte", 12), beyond(1, "line", 1)
    (('600 bytes behind the 12 announced faces passed over',), ('1 line behind the one announced face passed over',))
    """
    many = "" if count == 1 else "s"
    announced = "one announced face" if faces == 1 else f"{faces} announced faces"
    return (f"{count} {unit}{many} behind the {announced} passed over",)
