"""For how long two surfaces in free flight certainly go on crossing each other, once they do.

They touch while an edge of one passes through a triangle of the other. That is told by the distances of its ends from
the planes of the triangle and of its sides; the ends move no faster, and turn no more sharply, than the bodies let
them.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.crossing import meeting
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import MARGIN
from harness.narrowphase.placed_parts import push_near_halves, triangle_a, triangle_b
from harness.narrowphase.tree_pairs import NO_NODES, NodePair, Trees
from harness.narrowphase.vectors import Triangle, Vector, cross, dot, minus, plus, scaled
from harness.narrowphase.verdicts import PairVerdict

# Halvings of a time until the proof succeeds.
HALVINGS = 40
# Halvings of what is left between a time that was proved and one that was not.
REFINEMENTS = 10
# Crossing triangles among which the ones that cross longest are chosen, where none do for long enough.
TRIALS = 6


class LongestCrossing(NamedTuple):
    """Two triangles that cross.

    Attributes
    ----------
    lasts : s, for how long they go on to
    leaves : of either tree; -1 if none were found to cross, which proves nothing
    """

    lasts: float
    leaves: NodePair


class MovingEdge(NamedTuple):
    """An edge as seen from a triangle, which stands still.

    Attributes
    ----------
    p, q : m, its ends
    velocity_p, velocity_q : m/s, of the ends
    bend, growth : m/s^2 and m/s^3: after t the ends have accelerated by at most bend + growth t
    """

    p: Vector
    q: Vector
    velocity_p: Vector
    velocity_q: Vector
    bend: float
    growth: float


Side = tuple[Vector, Vector]
"""Of a triangle: the corner at which a side begins, and the unit vector inward from the side."""


class Heights(NamedTuple):
    """How far the ends of an edge are on either side of the plane of a triangle.

    Attributes
    ----------
    above, below : m, of the first end above the plane, and of the second below it
    rise, fall : m/s, at which these grow
    """

    above: float
    below: float
    rise: float
    fall: float


class Piercing(NamedTuple):
    """Where the ends of an edge are, and for how long they are looked at.

    Attributes
    ----------
    ends : Heights
    time : s
    slack : m, by which an acceleration can change a distance in this time
    """

    ends: Heights
    time: float
    slack: float


@kernel
def longest_crossing(
    trees: Trees, seen: RelativeMotion, start: NodePair, enough: float, most_steps: int, stack: Ints
) -> LongestCrossing:
    """Of the parts of two surfaces below two nodes: triangles that cross, and for how long they go on to.

    Parameters
    ----------
    trees : Trees
    seen : RelativeMotion of the bodies
    start : the nodes
    enough : s; the search ends at triangles that cross for so long, or else with the best of `TRIALS`
    most_steps : pairs of nodes to look at
    stack : (DEPTH, 2) int array, written
    """
    longest, leaves, trials, pose = 0.0, NO_NODES, 0, seen.pose
    margin = MARGIN * (pose.size_a + pose.size_b)
    stack[0, 0], stack[0, 1] = start
    height, steps = 1, 0
    while height > 0 and steps < most_steps:
        steps += 1
        height -= 1
        nodes = NodePair(stack[height, 0], stack[height, 1])
        right_a, right_b = trees.a.right[nodes.a], trees.b.right[nodes.b]
        if right_a < 0 and right_b < 0:
            one, other = triangle_a(trees.a, pose, -1 - right_a), triangle_b(trees.b, pose, -1 - right_b)
            if meeting(one, other, margin) == PairVerdict.TOUCHING:
                time = crossing_lasts(one, other, seen)
                trials += 1
                if time > longest or leaves.a < 0:
                    longest, leaves = time, nodes
                if 0.0 < longest >= enough or trials == TRIALS:
                    break
        else:
            height = push_near_halves(trees, pose, nodes, margin, stack, height)
    return LongestCrossing(longest, leaves)


@kernel
def crossing_lasts(one: Triangle, other: Triangle, seen: RelativeMotion) -> float:
    """For how long an edge of one triangle goes on passing through the other, s; 0 if none does.

    Parameters
    ----------
    one, other : Triangle of bodies a and b, from the centre of a in its axes, m
    seen : RelativeMotion of the bodies
    """
    offset = seen.pose.offset
    apart, speed = sqrt(dot(offset, offset)), sqrt(dot(seen.drift, seen.drift))
    longest = 0.0
    for side in range(2):
        for k in range(3):
            if side == 0:
                face, p, q = one, other[k], other[(k + 1) % 3]
            else:
                face, p, q = other, one[k], one[(k + 1) % 3]
            velocity_p, velocity_q = passing_velocity(p, seen), passing_velocity(q, seen)
            centre = offset if side == 0 else (0.0, 0.0, 0.0)  # of the body with the edge
            arm_p, arm_q = minus(p, centre), minus(q, centre)
            arm = sqrt(max(dot(arm_p, arm_p), dot(arm_q, arm_q)))
            rate_edge, rate_face = sqrt(dot(seen.spin_b, seen.spin_b)), sqrt(dot(seen.spin_a, seen.spin_a))
            if side == 1:
                velocity_p, velocity_q = scaled(velocity_p, -1.0), scaled(velocity_q, -1.0)
                rate_edge, rate_face = rate_face, rate_edge
            # as seen from the face, which turns: the edge goes round its own centre, and Coriolis and centrifugal terms
            bend = rate_edge**2 * arm + 2.0 * rate_face * (speed + rate_edge * arm) + rate_face**2 * (apart + arm)
            growth = rate_face**2 * speed
            edge = MovingEdge(p, q, velocity_p, velocity_q, bend, growth)
            longest = max(longest, edge_stays(face, edge, longest))
    return longest


@kernel
def passing_velocity(point: Vector, seen: RelativeMotion) -> Vector:
    """With which body b passes body a at a point, m/s, in the axes of a."""
    round_b = cross(seen.spin_b, minus(point, seen.pose.offset))
    return plus(seen.drift, minus(round_b, cross(seen.spin_a, point)))


@kernel
def edge_stays(face: Triangle, edge: MovingEdge, known: float) -> float:
    """For how long an edge passes through a triangle, s, or 0 if that is shorter than what is known already (s)."""
    normal = cross(minus(face[1], face[0]), minus(face[2], face[0]))
    area = sqrt(dot(normal, normal))
    if not area > 0.0:
        return 0.0
    normal = scaled(normal, 1.0 / area)
    if dot(normal, minus(edge.p, face[0])) < 0.0:
        edge = MovingEdge(edge.q, edge.p, edge.velocity_q, edge.velocity_p, edge.bend, edge.growth)
    above, below = dot(normal, minus(edge.p, face[0])), -dot(normal, minus(edge.q, face[0]))
    if not (above > 0.0 and below > 0.0):
        return 0.0
    inward0, inward1 = inward(face[0], face[1], normal), inward(face[1], face[2], normal)
    inward2 = inward(face[2], face[0], normal)
    rise, fall = dot(normal, edge.velocity_p), -dot(normal, edge.velocity_q)
    fastest = sqrt(max(dot(edge.velocity_p, edge.velocity_p), dot(edge.velocity_q, edge.velocity_q)))
    along = minus(edge.q, edge.p)
    time = 0.5 * sqrt(dot(along, along)) / fastest if fastest > 0.0 else np.inf
    time = min(time, sqrt(2.0 * (above + below) / edge.bend) if edge.bend > 0.0 else np.inf)
    if time == np.inf:
        time = 1e6 if edge.growth == 0.0 else 0.0
    inside = (face[0], inward0), (face[1], inward1), (face[2], inward2)
    known_to_fail = np.inf
    for _ in range(HALVINGS):
        if time <= known:
            return 0.0
        if stays_through(inside, edge, Heights(above, below, rise, fall), time):
            break
        known_to_fail = time
        time *= 0.5
    else:
        return 0.0
    for _ in range(REFINEMENTS):
        if known_to_fail == np.inf:
            break
        middle = 0.5 * (time + known_to_fail)
        if stays_through(inside, edge, Heights(above, below, rise, fall), middle):
            time = middle
        else:
            known_to_fail = middle
    return time


@kernel
def stays_through(inside: tuple[Side, Side, Side], edge: MovingEdge, ends: Heights, time: float) -> bool:
    """Whether an edge certainly passes through a triangle until a time, s."""
    slack = 0.5 * (edge.bend + edge.growth * time) * time * time
    through = Piercing(ends, time, slack)
    return (
        min(ends.above, ends.above + ends.rise * time) > slack
        and min(ends.below, ends.below + ends.fall * time) > slack
        and stays_inside(inside[0][0], inside[0][1], edge, through)
        and stays_inside(inside[1][0], inside[1][1], edge, through)
        and stays_inside(inside[2][0], inside[2][1], edge, through)
    )


@kernel
def inward(begin: Vector, end: Vector, normal: Vector) -> Vector:
    """At right angles to an edge of a triangle, in its plane, of length 1, or 0 for an edge without length."""
    axis = cross(normal, minus(end, begin))
    length = sqrt(dot(axis, axis))
    return scaled(axis, 1.0 / length) if length > 0.0 else axis


@kernel
def stays_inside(corner: Vector, axis: Vector, edge: MovingEdge, through: Piercing) -> bool:
    """Whether a moving edge passes the plane of a triangle on the inner side of one of its sides, until a time.

    It passes at the mean of its ends weighted by how far the other one is from the plane. So this is the sign of a sum
    of two products, each of factors that change linearly with time but for the slack.

    Parameters
    ----------
    corner : m, of the triangle
    axis : unit vector inward from the side that begins there
    edge : MovingEdge
    through : Piercing
    """
    ends = through.ends
    above, below, rise, fall = ends.above, ends.below, ends.rise, ends.fall
    time, slack = through.time, through.slack
    inside_p, inside_q = dot(axis, minus(edge.p, corner)), dot(axis, minus(edge.q, corner))
    into_p, into_q = dot(axis, edge.velocity_p), dot(axis, edge.velocity_q)
    first = inside_p * below + inside_q * above
    second = into_p * below + inside_p * fall + into_q * above + inside_q * rise
    third = into_p * fall + into_q * rise
    last = first + time * (second + time * third)
    factors = abs(inside_p) + abs(inside_q) + above + below
    factors += time * (abs(into_p) + abs(into_q) + abs(rise) + abs(fall))
    return min(first, last) - 0.25 * abs(third) * time * time > slack * (factors + 2.0 * slack)
