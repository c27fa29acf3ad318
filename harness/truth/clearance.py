"""How far apart two parts of bodies in flight are, at the worst time of an interval.

The formulas and what they rest on stand in `separation`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.truth.parts import Parts
from harness.truth.vectors import cross, dot, norm, normalised, turned


class PlacedPart(NamedTuple):
    """The part of one body in each of k cells, in the middle of the interval, in the axes of the world.

    Attributes
    ----------
    turn : (3, 3, k), from the axes of the body
    spin : (3, k), rad/s
    rate : (k,), rad/s
    size : (k,), m
    centre : (3, k), m, from the centre of the body
    radius, half : (k,), m, of the ball and of the slab
    normal : (3, k), of the slab
    """

    turn: Floats
    spin: Floats
    rate: Floats
    size: Floats
    centre: Floats
    radius: Floats
    normal: Floats
    half: Floats


def clearance_of_discs(
    one: PlacedPart, other: PlacedPart, axis: Floats, way: Floats, drift: Floats, half: Floats
) -> Floats:
    """(k,) m: what is left between two parts along axes at the worst time of each cell."""
    turns = cross(axis, one.spin), cross(axis, other.spin)
    gap = dot(axis, way)
    rate = dot(axis, drift) + dot(other.centre, turns[1]) - dot(one.centre, turns[0])
    bend = np.zeros_like(gap)
    for part, turn in zip((one, other), turns, strict=True):
        bend += norm(turn) * (norm(cross(part.spin, part.centre)) + part.rate * part.radius)
    bend *= 1.0 + 1e-12
    ends = []
    for time in (-half, half):
        clearance = gap + time * rate
        for part, turn in zip((one, other), turns, strict=True):
            clearance -= _reach(part, axis + time * turn)
        ends.append(clearance)
    return np.asarray(np.minimum(*ends) - 0.5 * bend * half * half)


def _reach(part: PlacedPart, axis: Floats) -> Floats:
    """How far a part reaches from its centre along axes of any length."""
    in_slab = part.half * np.abs(dot(axis, part.normal)) + part.radius * norm(cross(axis, part.normal))
    return np.asarray(np.minimum(part.radius * norm(axis), in_slab))


def placed_corners(parts: Parts, part: PlacedPart, triangles: Ints) -> Floats:
    """(3, 3, k) m: of coordinate and corner, from the centre of the body."""
    corners = parts.corners[:, :, triangles]
    return np.stack([part.size * turned(part.turn, corners[:, corner]) for corner in range(3)], axis=1)


def clearance_of_triangles(
    one: Floats,
    other: Floats,
    bodies: tuple[PlacedPart, PlacedPart],
    around: tuple[Floats, Floats],
    flight: tuple[Floats, Floats],
    half: Floats,
) -> Floats:
    """(k,) m: as `clearance_of_discs`, between two triangles along the axis that is best in the middle of the cell.

    Parameters
    ----------
    one, other : (3, 3, k), corners from the centres of their bodies
    bodies : whose spins matter
    around : (k,) m, radii around the triangles
    flight : (3, k) m and m/s, of the second centre from the first
    half : (k,) s
    """
    offset, drift = flight
    axis = _best_axis(one, other + offset[:, None])
    turns = [cross(axis, body.spin) for body in bodies]
    gap, rate, bend = dot(axis, offset), dot(axis, drift), np.zeros_like(half)
    for body, corners, turn, radius in zip(bodies, (one, other), turns, around, strict=True):
        speeds = [norm(cross(body.spin, corners[:, corner])) for corner in range(3)]
        bend += norm(turn) * (np.maximum.reduce(speeds) + body.rate * radius)
    bend *= 1.0 + 1e-12
    ends = []
    for time in (-half, half):
        forward, back = axis + time * turns[0], axis + time * turns[1]
        highest = np.maximum.reduce([dot(forward, one[:, corner]) for corner in range(3)])
        lowest = np.minimum.reduce([dot(back, other[:, corner]) for corner in range(3)])
        reach = around[0] * norm(forward) + around[1] * norm(back)
        ends.append(gap + time * rate + lowest - highest - reach)
    return np.asarray(np.minimum(*ends) - 0.5 * bend * half * half)


def _best_axis(one: Floats, other: Floats) -> Floats:
    """(3, k): of some directions that along which the second triangle is farthest beyond the first."""
    edges, other_edges = (np.roll(corners, -1, axis=1) - corners for corners in (one, other))
    normals = [cross(some[:, 0], some[:, 1]) for some in (edges, other_edges)]
    axes = list(normals)
    for some, normal in zip((edges, other_edges), normals, strict=True):
        axes += [cross(normal, some[:, edge]) for edge in range(3)]
    axes += [cross(edges[:, a], other_edges[:, b]) for a in range(3) for b in range(3)]
    axes += [other.mean(axis=1) - one.mean(axis=1)]
    ways = other[:, :, None] - one[:, None]  # of coordinate, corner of the second, of the first
    squared = np.einsum("xbak,xbak->bak", ways, ways).reshape(9, -1)
    nearest = squared.argmin(axis=0)
    axes.append(np.take_along_axis(ways.reshape(3, 9, -1), nearest[None, None], axis=1)[:, 0])
    best, most = np.zeros_like(axes[0]), np.full(one.shape[-1], -np.inf)
    for axis in axes:
        along = normalised(axis)
        low, high, other_low, other_high = _span(along, one) + _span(along, other)
        forward, back = other_low - high, low - other_high
        gap = np.maximum(forward, back)
        better = (gap > most) & (dot(along, along) > 0.5)
        best = np.where(better, np.where(forward >= back, along, -along), best)
        most = np.where(better, gap, most)
    return best


def _span(axis: Floats, corners: Floats) -> tuple[Floats, Floats]:
    heights = [dot(axis, corners[:, corner]) for corner in range(3)]
    return np.minimum.reduce(heights), np.maximum.reduce(heights)
