"""The judge of distances: how far two bodies are apart, in exact arithmetic and proven from both sides.

The squared distance of two triangles or two hulls is a rational number. What certifies it is two points, one of either
body, which bound it from above, and planes, along whose normals parts of the bodies are apart, which bound it from
below: of hulls one plane, of meshes a tree of them, which covers every pair of triangles. A certificate is checked by
itself, by nothing but integers; floats only propose where to look. Nothing is shared with the kernels.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats, Ints
from harness.compare.convex import CommonPoint, connect
from harness.compare.exact import PlacedPoints, Point, dot, world_points

Parts: TypeAlias = NDArray[Any]
"""(f, k) int array, the corners of each triangle; of a hull one row with all of its vertices."""
Weights: TypeAlias = tuple[tuple[int, int], ...]
"""(vertex, weight), positive."""

_NO_WEIGHTS: tuple[Weights, Weights] = ((), ())
# Of the largest coordinate: less than floats lose on the way, so that what they leave out is left out rightly.
_ROUNDING = 1e-12
# Bits of a normal of parts that are farther apart than the nearest: few, so that products stay short.
_NORMAL_BITS = 40


@dataclass(frozen=True)
class Separation:
    """Parts of two bodies and the plane that keeps them apart.

    Parameters
    ----------
    first, second : numbers of triangles
    normal : from the second part to the first
    """

    first: tuple[int, ...]
    second: tuple[int, ...]
    normal: Point


@dataclass(frozen=True)
class DistanceCertificate:
    """The distance of two bodies, proven.

    Parameters
    ----------
    upper, lower : bounds on the squared distance, m²; equal, and 0 where the bodies touch
    weights : of the nearest points, of vertices of a triangle of either body
    planes : Separation of all parts; none where they touch
    unit : m, of the integer coordinates, which are relative to the first body's position
    """

    upper: Fraction
    lower: Fraction
    weights: tuple[Weights, Weights]
    planes: tuple[Separation, ...]
    unit: Fraction

    @property
    def gap(self) -> float:
        """m, to within rounding of 1e-16 of itself."""
        return root(self.upper)

    def check(self, first: PlacedPoints, faces: Parts, second: PlacedPoints, other_faces: Parts) -> None:
        """Prove the bounds anew from the bodies alone.

        Parameters
        ----------
        first, second : PlacedPoints vertices
        faces, other_faces : (f, 3) int arrays; of a hull one row with all of its vertices

        Raises
        ------
        ArithmeticError
            If the points are not of the bodies or not as near as is said, or the planes do not keep all parts of one as
            far from all parts of the other.
        """
        one, other, unit = world_points(first, second)
        positive = all(weight > 0 for end in self.weights for _, weight in end)
        inside = all(
            any({place for place, _ in end} <= set(part) for part in parts.tolist())
            for end, parts in zip(self.weights, (faces, other_faces), strict=True)
        )
        squared = _squared_between(self.weights, one, other) * unit * unit
        if not (positive and inside and unit == self.unit and squared == self.upper >= self.lower):
            raise ArithmeticError("the nearest points do not bound the distance as they should")
        if self.upper == 0:
            return
        covered = np.zeros((len(faces), len(other_faces)), np.bool_)
        for part in self.planes:
            if _squared_along(part, one, other, faces, other_faces) * unit * unit < self.lower:
                raise ArithmeticError("a plane does not bound the distance as it should")
            covered[np.ix_(part.first, part.second)] = True
        if not covered.all():
            raise ArithmeticError("the planes leave out a pair of triangles")


def hull_distance(first: PlacedPoints, second: PlacedPoints) -> DistanceCertificate:
    """The distance of two hulls as solids, with its certificate."""
    whole, other_whole = (np.arange(len(placed.points))[None] for placed in (first, second))
    return surface_distance(first, whole, second, other_whole)


def surface_distance(
    first: PlacedPoints, faces: Parts, second: PlacedPoints, other_faces: Parts
) -> DistanceCertificate:
    """The distance of two surfaces, with its certificate.

    Parameters
    ----------
    first, second : PlacedPoints vertices
    faces, other_faces : (f, k) int arrays, the corners of each triangle, or of other convex parts
    """
    one, other, unit = world_points(first, second)
    rough, other_rough = _floats(one, unit)[faces], _floats(other, unit)[other_faces]
    slack = _ROUNDING * max(float(np.abs(rough).max()), float(np.abs(other_rough).max()))
    best, weights, limit, along = Fraction(-1), _NO_WEIGHTS, np.inf, np.array([1.0, 0.0, 0.0])
    waiting = [(0.0, 0, np.arange(len(faces)), np.arange(len(other_faces)), along)]
    planes, made = [], 0
    while waiting:
        apart, _, some, others, axis = heapq.heappop(waiting)
        if apart <= limit + slack:
            axis, apart = _best_axis(rough[some], other_rough[others], along)
        if apart > limit + slack:
            planes.append(Separation(tuple(some.tolist()), tuple(others.tolist()), _integers(axis)))
        elif len(some) == len(others) == 1:
            corners, other_corners = faces[some[0]].tolist(), other_faces[others[0]].tolist()
            found = connect([one[k] for k in corners], [other[k] for k in other_corners])
            ends = _named(found.first, corners), _named(found.second, other_corners)
            if isinstance(found, CommonPoint):
                return DistanceCertificate(Fraction(0), Fraction(0), ends, (), unit)
            squared = _squared_between(ends, one, other)
            if best < 0 or squared < best:
                best, weights, limit = squared, ends, root(squared * unit * unit)
                along = _unit_floats(found.plane.normal)
            planes.append(Separation((int(some[0]),), (int(others[0]),), found.plane.normal))
        else:
            for half, half_other in _halves(rough, some, other_rough, others):
                made += 1
                way, near = _best_axis(rough[half], other_rough[half_other], along)
                heapq.heappush(waiting, (near, made, half, half_other, way))
    lower = min(_squared_along(part, one, other, faces, other_faces) for part in planes)
    return DistanceCertificate(best * unit * unit, lower * unit * unit, weights, tuple(planes), unit)


def root(squared: Fraction) -> float:
    """The square root of a fraction, rounded once or twice, whatever its size."""
    if squared == 0:
        return 0.0
    shift = max(0, 140 - (squared.numerator.bit_length() - squared.denominator.bit_length()))
    shift += shift % 2
    return float(Fraction(isqrt((squared.numerator << shift) // squared.denominator), 1 << (shift // 2)))


def _named(weights: Sequence[tuple[int, int]], names: Sequence[int]) -> Weights:
    """Weights of corners as weights of vertices."""
    return tuple((names[place], weight) for place, weight in weights)


def _squared_between(ends: tuple[Weights, Weights], one: Sequence[Point], other: Sequence[Point]) -> Fraction:
    """The squared distance of two weighted points."""
    totals = [sum(weight for _, weight in end) for end in ends]
    point, other_point = _mixed(ends[0], one), _mixed(ends[1], other)
    between = [a * totals[1] - b * totals[0] for a, b in zip(point, other_point, strict=True)]
    return Fraction(sum(part * part for part in between), (totals[0] * totals[1]) ** 2)


def _mixed(weights: Weights, points: Sequence[Point]) -> list[int]:
    return [sum(weight * points[place][axis] for place, weight in weights) for axis in range(3)]


def _squared_along(
    part: Separation, one: Sequence[Point], other: Sequence[Point], faces: Parts, other_faces: Parts
) -> Fraction:
    """The square of how far parts are apart along the normal of their plane; 0 if they are not."""
    low = min(dot(part.normal, one[k]) for k in set(faces[list(part.first)].ravel().tolist()))
    high = max(dot(part.normal, other[k]) for k in set(other_faces[list(part.second)].ravel().tolist()))
    return Fraction(max(0, low - high) ** 2, dot(part.normal, part.normal))


def _best_axis(corners: Floats, other_corners: Floats, along: Floats) -> tuple[Floats, float]:
    """A direction along which the first of two parts is far beyond the second, and how far, in floats."""
    points, others = corners.reshape(-1, 3), other_corners.reshape(-1, 3)
    centres = points.mean(axis=0) - others.mean(axis=0)
    axes = np.vstack([np.eye(3), -np.eye(3), along, centres / (np.linalg.norm(centres) or 1.0)])
    apart = np.einsum("nk,ak->an", points, axes).min(axis=1) - np.einsum("nk,ak->an", others, axes).max(axis=1)
    best = int(apart.argmax())
    return axes[best], float(apart[best])


def _halves(rough: Floats, some: Ints, other_rough: Floats, others: Ints) -> Iterator[tuple[Ints, Ints]]:
    """The larger of two parts in halves, with the other part."""
    extent, other_extent = (np.ptp(part.reshape(-1, 3), axis=0) for part in (rough[some], other_rough[others]))
    if len(others) == 1 or (len(some) > 1 and extent.max() >= other_extent.max()):
        middles = rough[some].mean(axis=1)[:, extent.argmax()]
        for half in np.array_split(some[np.argsort(middles, kind="stable")], 2):
            yield half, others
    else:
        middles = other_rough[others].mean(axis=1)[:, other_extent.argmax()]
        for half in np.array_split(others[np.argsort(middles, kind="stable")], 2):
            yield some, half


def _integers(axis: Floats) -> Point:
    """A direction in integers, nearly the same."""
    x, y, z = (round(part * (1 << _NORMAL_BITS)) for part in axis.tolist())
    return x, y, z


def _unit_floats(normal: Point) -> Floats:
    length = isqrt(dot(normal, normal) << 128)
    return np.array([float(Fraction(part << 64, length)) for part in normal])


def _floats(points: Sequence[Point], unit: Fraction) -> Floats:
    return np.array([[part * unit.numerator / unit.denominator for part in point] for point in points])
