"""When two surfaces touch soon after their hulls have come near each other: few of their triangles can.

Along the axis on which the hulls were apart, or nearly are, a window of time ahead, all of one body is above some
height and all of the other is below some other. So only triangles that come below the second of one, and above the
first of the other, can touch in the window: two small caps, for bodies that bulge, whose triangles are then advanced
pair by pair. Nothing is asked of pairs of nodes, of which a search through both trees looks at a thousand.

A point at p from its centre moves along the axis n at p.(n x w), which changes by at most |n x w| |w x p| a second. So
its height during a time t is at least the lesser of p.n and p.(n + t (n x w)), less t^2 / 2 times this bound.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel, strict_step
from harness.narrowphase.free_flight import fastest_passing
from harness.narrowphase.motion_bounds import Instant, moving_disc_a, moving_disc_b, until_discs_touch
from harness.narrowphase.support import SupportMap, support
from harness.narrowphase.tree_pairs import DEPTH, Trees
from harness.narrowphase.triangle_tree import TriangleTree, centre_of, normal_of, radius_of, thickness_of
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, scaled, turned_back

# Triangles of a cap, at most; of more, the window is halved, so often.
ROOM, HALVINGS = 96, 3
# Pairs of triangles that may touch in a window, at most.
MOST_PAIRS = 512
# Of the mean size: how far the bodies may come towards each other in a window.
TRAVEL = 0.02
# Of the mean size: how far hulls may be in each other along the axis in a window; deeper ones hold too many triangles.
DEEPEST = 0.05
# Windows after which surfaces are searched through their trees: those that are in each other's hollows.
MOST_WINDOWS = 12


class Rise(NamedTuple):
    """How high the points of a body are along an axis from the beginning to the end of a window.

    Attributes
    ----------
    begin, end : vectors in the axes of the body, times its size; a point p is at p.begin + at_begin at first
    at_begin, at_end : m
    bend : m, by how much it may be lower in between, and at the end
    """

    begin: Vector
    end: Vector
    at_begin: float
    at_end: float
    bend: float


class Cap(NamedTuple):
    """Room for the triangles of a body that come below a height: leaves and, of each, how low it comes, m."""

    leaves: Ints
    lowest: Floats
    stack: Ints


class Slab(NamedTuple):
    """What can touch in a window.

    Attributes
    ----------
    length : s, of the window
    count_a, count_b : triangles in the caps of either body; below 0 where there are too many
    """

    length: float
    count_a: int
    count_b: int


class NearLeaves(NamedTuple):
    """Room for pairs of triangles, as leaves, and of each how long they certainly stay apart, s.

    And for the spheres around the triangles of the second cap, (4, ROOM): centres, seen from body a, and radii.
    """

    leaves: Ints
    waits: Floats
    balls: Floats


@kernel
def empty_pairs() -> NearLeaves:
    """Uninitialised."""
    return NearLeaves(np.empty((MOST_PAIRS, 2), np.int64), np.empty(MOST_PAIRS), np.empty((4, ROOM)))


@kernel
def empty_cap() -> Cap:
    """Uninitialised."""
    return Cap(np.empty(ROOM, np.int64), np.empty(ROOM), np.empty(DEPTH, np.int64))


@kernel
def slab_of(
    hull_a: SupportMap, hull_b: SupportMap, trees: Trees, at: Instant, axis: Vector, most: float, cap_a: Cap, cap_b: Cap
) -> Slab:
    """The triangles of two bodies that can touch in the window that begins at an instant.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    trees : Trees
    at : Instant
    axis : unit vector, on which body a is above body b but for little
    most : s, for how long
    cap_a, cap_b : written; heights are counted upwards from a's centre for a, and downwards for b
    """
    a, b = at.flight.a, at.flight.b
    drift = dot(axis, minus(b.velocity, a.velocity))
    across_a, across_b = cross(axis, a.spin), cross(axis, b.spin)
    turn_a, turn_b = sqrt(dot(across_a, across_a)), sqrt(dot(across_b, across_b))
    bend_a, bend_b = turn_a * at.flight.rate_a * a.reach, turn_b * at.flight.rate_b * b.reach
    travel = TRAVEL * 0.5 * (a.size + b.size)
    speed = abs(drift) + turn_a * a.reach + turn_b * b.reach
    if speed > 0.0:
        most = min(most, travel / speed)
    if bend_a + bend_b > 0.0:
        most = min(most, sqrt(travel / (bend_a + bend_b)))
    down = scaled(axis, -1.0)
    count_a = count_b = -1
    if most == np.inf:  # they neither spin nor drift along the axis
        return Slab(most, count_a, count_b)
    for _ in range(HALVINGS):
        offset, slack = dot(axis, at.offset), 0.5 * most * most
        rise_a = rise_of(at.turn_a, a.size, axis, plus(axis, scaled(across_a, most)), 0.0, 0.0, slack * bend_a)
        end = minus(down, scaled(across_b, most))
        rise_b = rise_of(at.turn_b, b.size, down, end, -offset, -offset - drift * most, slack * bend_b)
        low_a, low_b = lowest_of(hull_a, rise_a), lowest_of(hull_b, rise_b)
        if -(low_a + low_b) > DEEPEST * 0.5 * (a.size + b.size):
            break
        count_a = below(trees.a, rise_a, at.flight.aim - low_b, cap_a)
        if count_a >= 0:
            count_b = below(trees.b, rise_b, at.flight.aim - low_a, cap_b)
            if count_b >= 0:
                break
        most *= 0.5
    return Slab(most, count_a, count_b)


@kernel
def near_leaves(trees: Trees, at: Instant, slab: Slab, cap_a: Cap, cap_b: Cap, found: NearLeaves) -> int:
    """The pairs of triangles of two caps that may touch in the window, written; how many, -1 if there is no room.

    The one whose triangles come lowest together stands first.
    """
    a, b, aim = at.flight.a, at.flight.b, at.flight.aim
    travel = slab.length * fastest_passing(a, b) + aim
    count, best, balls = 0, np.inf, found.balls
    for n in range(slab.count_b):
        other = moving_disc_b(trees.b, at, cap_b.leaves[n])
        balls[0, n], balls[1, n], balls[2, n] = plus(at.offset, other.arm)
        balls[3, n] = other.radius + travel
    for m in range(slab.count_a):
        one = moving_disc_a(trees.a, at, cap_a.leaves[m])
        (x, y, z), below_aim = one.arm, aim - cap_a.lowest[m]
        for n in range(slab.count_b):
            u, v, w, reach = balls[0, n] - x, balls[1, n] - y, balls[2, n] - z, one.radius + balls[3, n]
            if cap_b.lowest[n] >= below_aim or u * u + v * v + w * w >= reach * reach:
                continue
            lowest = cap_a.lowest[m] + cap_b.lowest[n]
            other = moving_disc_b(trees.b, at, cap_b.leaves[n])
            wait = until_discs_touch(one, other, at, slab.length).wait
            if wait == np.inf:
                continue
            if count == len(found.waits):
                return -1
            place = count
            if lowest < best:
                best, place = lowest, 0
                found.leaves[count, 0], found.leaves[count, 1] = found.leaves[0, 0], found.leaves[0, 1]
                found.waits[count] = found.waits[0]
            found.leaves[place, 0], found.leaves[place, 1] = cap_a.leaves[m], cap_b.leaves[n]
            found.waits[place] = wait
            count += 1
    return count


@strict_step
def rise_of(turn: Matrix, size: float, begin: Vector, end: Vector, at_begin: float, at_end: float, bend: float) -> Rise:
    """A `Rise`, from vectors in the world and how the body is turned."""
    return Rise(scaled(turned_back(turn, begin), size), scaled(turned_back(turn, end), size), at_begin, at_end, bend)


@strict_step
def lowest_of(hull: SupportMap, rise: Rise) -> float:
    """How low any point of a hull comes, m."""
    x, y, z = rise.begin
    k = support(hull, -x, -y, -z)
    first = x * hull.vertices[k, 0] + y * hull.vertices[k, 1] + z * hull.vertices[k, 2] + rise.at_begin
    x, y, z = rise.end
    k = support(hull, -x, -y, -z)
    last = x * hull.vertices[k, 0] + y * hull.vertices[k, 1] + z * hull.vertices[k, 2] + rise.at_end
    return float(min(first, last) - rise.bend)


@kernel
def below(tree: TriangleTree, rise: Rise, height: float, cap: Cap) -> int:
    """The triangles that come below a height (m), written; how many there are, -1 if there is no room for them."""
    c, stack = tree.corners, cap.stack
    x, y, z = rise.begin
    u, v, w = rise.end
    length_begin, length_end = dot(rise.begin, rise.begin), dot(rise.end, rise.end)
    limit = height + rise.bend
    stack[0] = 0
    waiting, count = 1, 0
    while waiting > 0:
        waiting -= 1
        node = stack[waiting]
        right = tree.right[node]
        if right < 0:
            k = -1 - right
            low = np.inf
            for corner in range(3):
                p, q, r = c[k, corner, 0], c[k, corner, 1], c[k, corner, 2]
                low = min(low, min(x * p + y * q + z * r + rise.at_begin, u * p + v * q + w * r + rise.at_end))
            if low < limit:
                if count == len(cap.leaves):
                    return -1
                cap.leaves[count], cap.lowest[count] = node, low - rise.bend
                count += 1
            continue
        p, q, r = centre_of(tree, node)
        i, j, k = normal_of(tree, node)
        radius, thick = radius_of(tree, node), thickness_of(tree, node)
        along = x * i + y * j + z * k
        # a little more than rounding takes from the part across
        wide = radius * (sqrt(max(0.0, length_begin - along * along)) + 1e-7 * sqrt(length_begin))
        first = x * p + y * q + z * r + rise.at_begin - (thick * abs(along) + wide)
        along = u * i + v * j + w * k
        wide = radius * (sqrt(max(0.0, length_end - along * along)) + 1e-7 * sqrt(length_end))
        last = u * p + v * q + w * r + rise.at_end - (thick * abs(along) + wide)
        if min(first, last) < limit:
            stack[waiting], stack[waiting + 1] = right, node + 1
            waiting += 2
    return count
