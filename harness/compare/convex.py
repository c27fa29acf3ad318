"""Two convex sets of exact points: do they share a point, and if not, what plane parts them.

The algorithm of Gilbert, Johnson and Keerthi for the point nearest to the origin in the difference of two hulls, in
integers, from where a walk of floats has ended. Without rounding it always ends, since every step comes strictly nearer
and there are finitely many simplices, and what it returns is a proof: weights of vertices of both sets that make the
same point, or the normal of a plane.
Two triangles are such sets as well, degenerate ones included.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, combinations

import numpy as np

from harness.compare.exact import Point, Points, determinant, dot, in_floats, minus
from harness.compare.proposal import probable_corners, probable_simplex


@dataclass(frozen=True)
class CommonPoint:
    """A point of both sets.

    Parameters
    ----------
    first, second : (index of a point of the set, weight); weights are positive and of the same sum in both
    """

    first: tuple[tuple[int, int], ...]
    second: tuple[tuple[int, int], ...]

    def holds(self, first: Sequence[Point], second: Sequence[Point]) -> bool:
        """Whether the weights really make the same point of both sets."""
        sums = [sum(weight for _, weight in side) for side in (self.first, self.second)]
        positive = all(weight > 0 for _, weight in self.first + self.second)
        return positive and sums[0] == sums[1] and _mixed(self.first, first) == _mixed(self.second, second)


@dataclass(frozen=True)
class Plane:
    """A plane between both sets.

    Parameters
    ----------
    normal : from the second set to the first; every point of the first lies strictly farther along it
    """

    normal: Point

    def holds(self, first: Sequence[Point], second: Sequence[Point]) -> bool:
        """Whether the plane really parts the sets."""
        return self.between(first, second) > 0

    def between(self, first: Sequence[Point], second: Sequence[Point]) -> int:
        """How far the first set begins beyond the end of the second along the normal, times the normal's length."""
        one, other = Points.of(first), Points.of(second)
        return dot(self.normal, minus(one[one.lowest(self.normal)], other[other.highest(self.normal)]))


@dataclass(frozen=True)
class Connection:
    """The shortest connection of two sets that share no point.

    Parameters
    ----------
    first, second : weights of its ends, as of a `CommonPoint`
    plane : across it
    """

    first: tuple[tuple[int, int], ...]
    second: tuple[tuple[int, int], ...]
    plane: Plane


def meet(first: Sequence[Point], second: Sequence[Point]) -> CommonPoint | Plane:
    """A common point of the hulls of two sets, or the plane across their shortest connection.

    The hulls are closed: sets that only touch have a common point.

    Parameters
    ----------
    first, second : integer points, at least one each

    >>> meet([(0, 0, 0)], [(2, 1, 0)])
    Plane(normal=(-2, -1, 0))
    >>> meet([(0, 0, 0), (2, 0, 0)], [(1, 0, 0)])
    CommonPoint(first=((0, 2), (1, 2)), second=((0, 2), (0, 2)))
    """
    found = connect(first, second)
    return found.plane if isinstance(found, Connection) else found


def connect(first: Sequence[Point], second: Sequence[Point]) -> CommonPoint | Connection:
    """A common point of the hulls of two sets, or their shortest connection; parameters as for `meet`."""
    first, second = Points.of(first), Points.of(second)
    simplex = [(a, b) for a, b in probable_simplex(first.rough, second.rough).tolist()]
    while True:
        corners = [minus(first[a], second[b]) for a, b in simplex]
        kept, weights, total = _nearest_to_origin(corners)
        simplex = [simplex[place] for place in kept]
        nearest = _mixed(tuple(zip(kept, weights, strict=True)), corners)
        end, other_end = (tuple((pair[k], w) for pair, w in zip(simplex, weights, strict=True)) for k in (0, 1))
        if nearest == (0, 0, 0):
            return CommonPoint(end, other_end)
        least, most = first.lowest(nearest), second.highest(nearest)
        if dot(nearest, minus(first[least], second[most])) * total >= dot(nearest, nearest):
            return Connection(end, other_end, Plane(nearest))
        simplex.append((least, most))


def _nearest_to_origin(corners: Sequence[Point]) -> tuple[tuple[int, ...], list[int], int]:
    """The corners whose simplex holds the point nearest to the origin inside, its weights, and their sum."""
    proposed = _proposed(corners)
    for kept, weights, total in chain(_inner_point(corners, proposed), _inner_points(corners)):
        nearest = _mixed(tuple(zip(kept, weights, strict=True)), corners)
        squared = dot(nearest, nearest)
        if all(dot(nearest, corner) * total >= squared for corner in corners):
            return kept, weights, total
    raise AssertionError("every simplex has a nearest point")


def _inner_points(corners: Sequence[Point]) -> Iterator[tuple[tuple[int, ...], list[int], int]]:
    """Of every set of independent corners the point of its span nearest to the origin, where it lies inside."""
    for size in range(1, len(corners) + 1):
        for kept in combinations(range(len(corners)), size):
            yield from _inner_point(corners, kept)


def _inner_point(corners: Sequence[Point], kept: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], list[int], int]]:
    """Of some independent corners the point of their span nearest to the origin, if it lies inside."""
    weights = _weights([corners[place] for place in kept])
    total = sum(weights)
    if total > 0 and min(weights) > 0:
        yield kept, weights, total


def _proposed(corners: Sequence[Point]) -> tuple[int, ...]:
    """Which corners it probably is, by floats: they are tried first, and what floats get wrong costs time only."""
    if len(corners) == 1:
        return (0,)
    near = in_floats(corners)
    found = probable_corners(near / (np.abs(near).max() or 1.0), np.empty(3))
    return tuple(place for place in range(len(corners)) if found & (1 << place))


def _weights(corners: Sequence[Point]) -> list[int]:
    """Weights of the point nearest to the origin on the span of up to four corners; all 0 if they are dependent."""
    if len(corners) == 1:
        return [1]
    start = corners[0]
    if len(corners) == 2:
        edge = minus(corners[1], start)
        length, along = dot(edge, edge), -dot(edge, start)
        return [length - along, along]
    if len(corners) == 3:
        e, f = minus(corners[1], start), minus(corners[2], start)
        ee, ef, ff, es, fs = dot(e, e), dot(e, f), dot(f, f), -dot(e, start), -dot(f, start)
        along, across = es * ff - fs * ef, ee * fs - ef * es
        return [ee * ff - ef * ef - along - across, along, across]
    a, b, c, d = corners
    volumes = [determinant(b, c, d), -determinant(a, c, d), determinant(a, b, d), -determinant(a, b, c)]
    return volumes if sum(volumes) > 0 else [-volume for volume in volumes]


def _mixed(weights: Sequence[tuple[int, int]], points: Sequence[Point]) -> Point:
    """The sum of weighted points."""
    x = sum(weight * points[place][0] for place, weight in weights)
    y = sum(weight * points[place][1] for place, weight in weights)
    z = sum(weight * points[place][2] for place, weight in weights)
    return x, y, z
