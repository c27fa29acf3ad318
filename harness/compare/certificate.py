"""The judge's verdict on two bodies and its proof, in the form that JSON holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt, sqrt
from typing import Any, TypeAlias

from harness.compare.convex import CommonPoint, Plane
from harness.compare.exact import Point, dot

Certificate: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Judgement:
    """Whether two bodies touch, by exact arithmetic.

    Parameters
    ----------
    touching : closed sets, so that a gap of exactly 0 touches
    gap : m, between the surfaces; negative if they overlap, by the penetration depth, of hulls known to three tenths
        at least. Of overlapping meshes, which are surfaces, at least as deep
    certificate : the proof; numbers that only a fraction can hold are text
    contained : a mesh lies wholly inside the other, and the surfaces do not touch
    """

    touching: bool
    gap: float
    certificate: Certificate
    contained: bool = False


def distance_along(plane: Plane, first: Sequence[Point], second: Sequence[Point], unit: Fraction) -> float:
    """m, how far two sets are apart along the normal of a plane; negative if they overlap."""
    normal, between = plane.normal, plane.between(first, second)
    squared = float(Fraction(between * between, dot(normal, normal)) * unit * unit)
    return sqrt(squared) if between >= 0 else -sqrt(squared)


def of_plane(plane: Plane, first: Sequence[Point], second: Sequence[Point]) -> Certificate:
    """The normal in floats where that still parts the sets exactly, else in integers."""
    length = isqrt(dot(plane.normal, plane.normal)) or 1
    rounded = [part / length for part in plane.normal]
    scaled = [Fraction(part) for part in rounded]
    denominator = max(part.denominator for part in scaled)
    x, y, z = (int(part * denominator) for part in scaled)
    if Plane((x, y, z)).holds(first, second):
        return {"kind": "separating plane", "normal": rounded}
    return {"kind": "separating plane", "normal": [str(part) for part in plane.normal]}


def of_common_point(
    common: CommonPoint, first: Sequence[Point], origin: Sequence[float], unit: Fraction
) -> Certificate:
    """The point in floats (m, in the world), and exactly: each vertex with its weight, in both bodies."""
    total = sum(weight for _, weight in common.first)
    point = [
        start + float(Fraction(sum(weight * first[place][axis] for place, weight in common.first), total) * unit)
        for axis, start in enumerate(origin)
    ]
    weights = [
        [[place, str(Fraction(weight, total))] for place, weight in side] for side in (common.first, common.second)
    ]
    return {"kind": "common point", "point": point, "first": weights[0], "second": weights[1]}
