"""For how long two bodies in free flight certainly go on touching, once they are in each other.

Surfaces touch while an edge of one passes through a triangle of the other. Convex bodies do while the origin is inside
a tetrahedron of differences of their points. Both are told by distances, and the points move no faster, and turn no
more sharply, than the bodies let them.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from harness.arrays import Ints
from harness.kernel import kernel
from harness.narrowphase.advancement import Motion
from harness.narrowphase.crossing import CROSSING, meeting, nearness, placed_a, placed_b, triangle_a, triangle_b
from harness.narrowphase.gjk import MARGIN, Relative, Seeds, difference, farthest, vertex_a, vertex_b
from harness.narrowphase.simplex import room_around_origin
from harness.narrowphase.support import SupportMap
from harness.narrowphase.triangle_distance import Triangle
from harness.narrowphase.triangle_tree import TriangleTree
from harness.narrowphase.vectors import Matrix, Vector, cross, dot, minus, plus, scaled, turned_back

# Halvings of a time until the proof succeeds, and rounds of making a tetrahedron roomier.
HALVINGS = 40
ROUNDS = 10
# Crossing triangles among which the ones that cross longest are chosen, where none do for long enough.
TRIALS = 6


@kernel
def lasting_crossing(
    tree_a: TriangleTree,
    tree_b: TriangleTree,
    pose: Relative,
    turn: Matrix,
    a: Motion,
    b: Motion,
    start: tuple[int, int],
    enough: float,
    most: int,
    stack: Ints,
) -> tuple[float, tuple[int, int]]:
    """Of the parts of two surfaces below two nodes: triangles that cross, and for how long they go on to, s.

    Parameters
    ----------
    tree_a, tree_b : TriangleTree
    pose : Relative
    turn : of the axes of a
    a, b : Motion
    start : the nodes
    enough : s; the search ends at triangles that cross for so long, or else with the best of `TRIALS`
    most : pairs of nodes to look at
    stack : (DEPTH, 2) int array, written

    Returns
    -------
    0 and (-1, -1) if none were found to cross, which proves nothing; else the time and the leaves.
    """
    longest, leaves, trials = 0.0, (-1, -1), 0
    margin = MARGIN * (pose.size_a + pose.size_b)
    stack[0, 0], stack[0, 1] = start
    height, steps = 1, 0
    while height > 0 and steps < most:
        steps += 1
        height -= 1
        node_a, node_b = stack[height, 0], stack[height, 1]
        right_a, right_b = tree_a.right[node_a], tree_b.right[node_b]
        if right_a < 0 and right_b < 0:
            one, other = triangle_a(tree_a, pose, -1 - right_a), triangle_b(tree_b, pose, -1 - right_b)
            if meeting(one, other, margin) == CROSSING:
                time = crossing_lasts(one, other, pose, turn, a, b)
                trials += 1
                if time > longest or leaves[0] < 0:
                    longest, leaves = time, (node_a, node_b)
                if longest >= enough or trials == TRIALS:
                    break
            continue
        larger_a = right_a >= 0 and tree_a.discs[node_a, 3] * pose.size_a >= tree_b.discs[node_b, 3] * pose.size_b
        if right_b < 0 or larger_a:
            a0, b0, a1, b1 = node_a + 1, node_b, right_a, node_b
        else:
            a0, b0, a1, b1 = node_a, node_b + 1, node_a, right_b
        near0 = nearness(placed_a(tree_a, pose, a0), placed_b(tree_b, pose, b0), margin)
        near1 = nearness(placed_a(tree_a, pose, a1), placed_b(tree_b, pose, b1), margin)
        if near0 > near1:  # the deeper one goes on top
            a0, b0, near0, a1, b1, near1 = a1, b1, near1, a0, b0, near0
        if near1 < 1.0:
            stack[height, 0], stack[height, 1] = a1, b1
            height += 1
        if near0 < 1.0:
            stack[height, 0], stack[height, 1] = a0, b0
            height += 1
    return longest, leaves


@kernel
def crossing_lasts(one: Triangle, other: Triangle, pose: Relative, turn: Matrix, a: Motion, b: Motion) -> float:
    """For how long an edge of one triangle goes on passing through the other, s; 0 if none does.

    Parameters
    ----------
    one, other : Triangle of bodies a and b, from the centre of a in its axes, m
    pose : Relative, of the bodies
    turn : of the axes of a
    a, b : Motion
    """
    spin_a, spin_b = turned_back(turn, a.spin), turned_back(turn, b.spin)
    drift = turned_back(turn, minus(b.velocity, a.velocity))
    longest = 0.0
    for side in range(2):
        for k in range(3):
            if side == 0:
                face, p, q = one, other[k], other[(k + 1) % 3]
            else:
                face, p, q = other, one[k], one[(k + 1) % 3]
            toward_p, toward_q = passing(p, pose, spin_a, spin_b, drift), passing(q, pose, spin_a, spin_b, drift)
            centre = pose.offset if side == 0 else (0.0, 0.0, 0.0)  # of the body with the edge
            arm_p, arm_q = minus(p, centre), minus(q, centre)
            arm = sqrt(max(dot(arm_p, arm_p), dot(arm_q, arm_q)))
            apart, speed = sqrt(dot(pose.offset, pose.offset)), sqrt(dot(drift, drift))
            rate_edge, rate_face = sqrt(dot(spin_b, spin_b)), sqrt(dot(spin_a, spin_a))
            if side == 1:
                toward_p, toward_q = scaled(toward_p, -1.0), scaled(toward_q, -1.0)
                rate_edge, rate_face = rate_face, rate_edge
            # as seen from the face, which turns: the edge goes round its own centre, and Coriolis and centrifugal terms
            bend = rate_edge**2 * arm + 2.0 * rate_face * (speed + rate_edge * arm) + rate_face**2 * (apart + arm)
            growth = rate_face**2 * speed
            longest = max(longest, edge_stays(face, p, q, toward_p, toward_q, bend, growth, longest))
    return longest


@kernel
def passing(point: Vector, pose: Relative, spin_a: Vector, spin_b: Vector, drift: Vector) -> Vector:
    """The speed at which body b passes body a at a point, in the axes of a, m/s."""
    return plus(drift, minus(cross(spin_b, minus(point, pose.offset)), cross(spin_a, point)))


@kernel
def edge_stays(
    face: Triangle, p: Vector, q: Vector, speed_p: Vector, speed_q: Vector, bend: float, growth: float, known: float
) -> float:
    """For how long an edge from p to q passes through a triangle that stands still, s, or 0 if shorter than known.

    Parameters
    ----------
    face, p, q : m
    speed_p, speed_q : of the ends, m/s
    bend, growth : m/s^2 and m/s^3: after t the ends have accelerated by at most bend + growth t
    known : s
    """
    normal = cross(minus(face[1], face[0]), minus(face[2], face[0]))
    area = sqrt(dot(normal, normal))
    if not area > 0.0:
        return 0.0
    normal = scaled(normal, 1.0 / area)
    if dot(normal, minus(p, face[0])) < 0.0:
        p, q, speed_p, speed_q = q, p, speed_q, speed_p
    above, below = dot(normal, minus(p, face[0])), -dot(normal, minus(q, face[0]))
    if not (above > 0.0 and below > 0.0):
        return 0.0
    inward0, inward1 = inward(face[0], face[1], normal), inward(face[1], face[2], normal)
    inward2 = inward(face[2], face[0], normal)
    rise_p, fall_q = dot(normal, speed_p), -dot(normal, speed_q)
    fastest = sqrt(max(dot(speed_p, speed_p), dot(speed_q, speed_q)))
    along = minus(q, p)
    time = 0.5 * sqrt(dot(along, along)) / fastest if fastest > 0.0 else np.inf
    time = min(time, sqrt(2.0 * (above + below) / bend) if bend > 0.0 else np.inf)
    if time == np.inf:
        time = 1e6 if growth == 0.0 else 0.0
    for _ in range(HALVINGS):
        if time <= known:
            return 0.0
        slack = 0.5 * (bend + growth * time) * time * time
        if (
            min(above, above + rise_p * time) > slack
            and min(below, below + fall_q * time) > slack
            and stays_inside(face[0], inward0, p, q, speed_p, speed_q, above, below, rise_p, fall_q, time, slack)
            and stays_inside(face[1], inward1, p, q, speed_p, speed_q, above, below, rise_p, fall_q, time, slack)
            and stays_inside(face[2], inward2, p, q, speed_p, speed_q, above, below, rise_p, fall_q, time, slack)
        ):
            return time
        time *= 0.5
    return 0.0


@kernel
def inward(begin: Vector, end: Vector, normal: Vector) -> Vector:
    """At right angles to an edge of a triangle, in its plane, of length 1, or 0 for an edge without length."""
    axis = cross(normal, minus(end, begin))
    length = sqrt(dot(axis, axis))
    return scaled(axis, 1.0 / length) if length > 0.0 else axis


@kernel
def stays_inside(
    corner: Vector,
    axis: Vector,
    p: Vector,
    q: Vector,
    speed_p: Vector,
    speed_q: Vector,
    above: float,
    below: float,
    rise_p: float,
    fall_q: float,
    time: float,
    slack: float,
) -> bool:
    """Whether a moving edge passes the plane of a triangle on the inner side of one of its edges, until a time.

    It passes at the mean of its ends weighted by how far the other one is from the plane. So this is the sign of a sum
    of two products, each of factors that change linearly with time but for the slack.
    """
    inside_p, inside_q = dot(axis, minus(p, corner)), dot(axis, minus(q, corner))
    into_p, into_q = dot(axis, speed_p), dot(axis, speed_q)
    first = inside_p * below + inside_q * above
    second = into_p * below + inside_p * fall_q + into_q * above + inside_q * rise_p
    third = into_p * fall_q + into_q * rise_p
    last = first + time * (second + time * third)
    factors = abs(inside_p) + abs(inside_q) + above + below
    factors += time * (abs(into_p) + abs(into_q) + abs(rise_p) + abs(fall_q))
    return min(first, last) - 0.25 * abs(third) * time * time > slack * (factors + 2.0 * slack)


@kernel
def overlap_lasts(
    hull_a: SupportMap, hull_b: SupportMap, pose: Relative, turn: Matrix, a: Motion, b: Motion, seeds: Seeds
) -> tuple[float, Seeds]:
    """For how long two overlapping hulls go on to overlap, s, and the corners of the tetrahedron that shows it.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    pose : Relative
    turn : of the axes of a
    a, b : Motion
    seeds : corners of a tetrahedron around the origin, as `gjk.hull_distance` gives them
    """
    s0, s1, s2, s3 = seeds
    p0, p1 = difference(hull_a, hull_b, pose, s0), difference(hull_a, hull_b, pose, s1)
    p2, p3 = difference(hull_a, hull_b, pose, s2), difference(hull_a, hull_b, pose, s3)
    room = room_around_origin(p0, p1, p2, p3)
    for _ in range(ROUNDS):
        outward = outward_of_nearest(p0, p1, p2, p3)
        seed = farthest(hull_a, hull_b, pose, outward)
        point = difference(hull_a, hull_b, pose, seed)
        at0, at1 = room_around_origin(point, p1, p2, p3), room_around_origin(p0, point, p2, p3)
        at2, at3 = room_around_origin(p0, p1, point, p3), room_around_origin(p0, p1, p2, point)
        best = max(max(at0, at1), max(at2, at3))
        if not best > room:
            break
        room = best
        if best == at0:
            p0, s0 = point, seed
        elif best == at1:
            p1, s1 = point, seed
        elif best == at2:
            p2, s2 = point, seed
        else:
            p3, s3 = point, seed
    spin_a, spin_b = turned_back(turn, a.spin), turned_back(turn, b.spin)
    drift = turned_back(turn, minus(b.velocity, a.velocity))
    rate_a, rate_b = sqrt(dot(spin_a, spin_a)), sqrt(dot(spin_b, spin_b))
    time = np.inf
    for k in range(4):
        seed = s0 if k == 0 else (s1 if k == 1 else (s2 if k == 2 else s3))
        round_a = cross(spin_a, vertex_a(hull_a, pose, seed >> 32))
        round_b = cross(spin_b, minus(vertex_b(hull_b, pose, seed & 0xFFFFFFFF), pose.offset))
        velocity = minus(minus(round_a, round_b), drift)
        speed = sqrt(dot(velocity, velocity))
        bend = rate_a * sqrt(dot(round_a, round_a)) + rate_b * sqrt(dot(round_b, round_b))
        if speed > 0.0 or bend > 0.0:
            time = min(time, 2.0 * room / (speed + sqrt(speed * speed + 2.0 * bend * room)))
    return max(0.0, time), (s0, s1, s2, s3)


@kernel
def outward_of_nearest(a: Vector, b: Vector, c: Vector, d: Vector) -> Vector:
    """Of the face of a tetrahedron that is nearest to the origin, which is inside: away from it."""
    best, nearest = a, np.inf
    for face in range(4):
        p, q, r = (a, b, c) if face == 0 else ((b, c, d) if face == 1 else ((c, d, a) if face == 2 else (d, a, b)))
        normal = cross(minus(q, p), minus(r, p))
        length = sqrt(dot(normal, normal))
        height = dot(normal, p)
        if abs(height) < nearest * length:
            nearest, best = abs(height) / length, scaled(normal, 1.0 if height > 0.0 else -1.0)
    return best
