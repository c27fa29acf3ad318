"""What a spinning hull sweeps: the surface of revolution about its axis of spin, which flies and does not turn.

While the surfaces of two bodies are apart, the bodies are, however they are turned. The gap of such surfaces closes no
faster than the centres approach, so that bodies that spin fast and approach slowly are advanced in a step what the
bounds on their points would take millions of steps for.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.free_flight import Motion, orientation, place
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, scaled, turned, turned_back, unit

# Directions tried, each nearer to that of the gap; and of the gap, what it is enough to know it to.
MOST_DIRECTIONS = 32
ENOUGH = 0.99


class Swept(NamedTuple):
    """The surface that a hull sweeps, about its centre.

    Attributes
    ----------
    hull : SupportMap
    size : m, factor on its vertices
    axis : of spin, in the world: a unit vector, or zero for a body that does not spin, which sweeps itself
    own : the axis in the axes of the body
    turn : from the axes of the body to those of the world
    """

    hull: SupportMap
    size: float
    axis: Vector
    own: Vector
    turn: Matrix


@kernel
def swept(hull: SupportMap, body: Motion) -> Swept:
    """What a body sweeps; it turns about its axis of spin, which therefore stands still in its own axes too."""
    axis, turn = unit(body.spin), orientation(body, 0.0)
    return Swept(hull, body.size, axis, turned_back(turn, axis), turn)


@kernel
def farthest(one: Swept, direction: Vector) -> Vector:
    """The point of the surface that reaches farthest in a direction, m from the centre, in the world."""
    vertices = one.hull.vertices
    if dot(one.axis, one.axis) == 0.0:
        back = turned_back(one.turn, direction)
        k = support(one.hull, back[0], back[1], back[2])
        return scaled(turned(one.turn, (vertices[k, 0], vertices[k, 1], vertices[k, 2])), one.size)
    along = dot(direction, one.axis)
    across = minus(direction, scaled(one.axis, along))
    breadth = sqrt(dot(across, across))
    most, height, radius = -np.inf, 0.0, 0.0
    for k in range(len(vertices)):
        vertex = vertices[k, 0], vertices[k, 1], vertices[k, 2]
        arm = cross(one.own, vertex)
        z, r = dot(one.own, vertex), sqrt(dot(arm, arm))
        if along * z + breadth * r > most:
            most, height, radius = along * z + breadth * r, z, r
    rim = scaled(across, radius / breadth) if breadth > 0.0 else (0.0, 0.0, 0.0)
    return scaled(plus(scaled(one.axis, height), rim), one.size)


@kernel
def apart_until(hull_a: SupportMap, hull_b: SupportMap, a: Motion, b: Motion, begin: float) -> float:
    """Until when two hulls are proved to be apart by what they sweep.

    The directions tried are those of the algorithm of Frank and Wolfe for the point of the Minkowski difference that
    is nearest to the origin; in each of them the gap closes at the speed of the centres along it.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    a, b : Motion
    begin : s

    Returns
    -------
    float
        s, not before `begin`; inf if they never touch. `begin` where what they sweep overlaps.
    """
    one, other = swept(hull_a, a), swept(hull_b, b)
    start, drift = minus(place(a, begin), place(b, begin)), minus(a.velocity, b.velocity)
    margin = MARGIN * (a.size + b.size + sqrt(dot(start, start)))
    nearest, wait = start, 0.0
    for _ in range(MOST_DIRECTIONS):
        length = sqrt(dot(nearest, nearest))
        if not length > margin:
            break
        axis = scaled(nearest, 1.0 / length)
        corner = plus(start, minus(farthest(one, scaled(axis, -1.0)), farthest(other, axis)))
        gap, closing = dot(axis, corner), -dot(axis, drift)
        if gap > margin:
            wait = max(wait, (gap - margin) / closing if closing > 0.0 else np.inf)
        if gap >= ENOUGH * length:
            break
        way = minus(corner, nearest)
        nearest = plus(nearest, scaled(way, min(1.0, -dot(nearest, way) / dot(way, way))))
    return begin + wait


@kernel
def apart_from_wall_until(hull: SupportMap, body: Motion, inward: Vector, half: float, begin: float) -> float:
    """The same for a hull and a wall, as `time_of_wall_impact` has them; `inward` is the normal of the wall."""
    lowest = plus(place(body, begin), farthest(swept(hull, body), scaled(inward, -1.0)))
    gap, closing = half + dot(inward, lowest) - 2.0 * MARGIN * (body.size + half), -dot(inward, body.velocity)
    if not gap > 0.0:
        return begin
    return begin + gap / closing if closing > 0.0 else np.inf
