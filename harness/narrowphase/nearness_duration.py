"""For how long a point of one body and a point of another, both in free flight, certainly stay near each other."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel
from harness.narrowphase.free_flight import RelativeMotion
from harness.narrowphase.gjk import Relative
from harness.narrowphase.placed_parts import triangle_a, triangle_b
from harness.narrowphase.tree_pairs import NodePair, Trees
from harness.narrowphase.triangle_distance import walk
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled
from harness.narrowphase.witness import nearest_weights


class WitnessPoints(NamedTuple):
    """A point of either body and how far they are apart, m; inf where there are none."""

    gap: float
    point_a: Vector
    point_b: Vector


NO_WITNESSES = WitnessPoints(np.inf, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def nearest_points(trees: Trees, pose: Relative, leaves: NodePair, margin: float) -> WitnessPoints:
    """Of the triangles of two leaves, the points nearest to each other; none of nodes that have more below them."""
    right_a, right_b = trees.a.right[leaves.a], trees.b.right[leaves.b]
    if right_a >= 0 or right_b >= 0:
        return NO_WITNESSES
    one, other = triangle_a(trees.a, pose, -1 - right_a), triangle_b(trees.b, pose, -1 - right_b)
    simplex, shares = nearest_weights(walk(one, other, minus(one[0], other[0]), margin, np.inf).simplex)
    point_a = point_b = (0.0, 0.0, 0.0)
    for corner in range(simplex.size):
        corners, share = simplex.vertices[corner], shares[corner]
        point_a = plus(point_a, scaled(one[corners // 3], share))
        point_b = plus(point_b, scaled(other[corners % 3], share))
    apart = minus(point_b, point_a)
    return WitnessPoints(sqrt(dot(apart, apart)), point_a, point_b)


@kernel
def nearness_lasts(points: WitnessPoints, seen: RelativeMotion, near: float) -> float:
    """For how long two points certainly stay within a distance `near`, m, of each other, s.

    In axes that do not turn, they pass each other at a velocity which changes by no more than the accelerations of
    both, as they go round: |apart + velocity t| + bend t^2 / 2 is not exceeded.
    """
    if not points.gap < near:
        return 0.0
    offset = seen.pose.offset
    round_a, round_b = cross(seen.spin_a, points.point_a), cross(seen.spin_b, minus(points.point_b, offset))
    apart, velocity = minus(points.point_b, points.point_a), plus(seen.drift, minus(round_b, round_a))
    bend = sqrt(dot(seen.spin_a, seen.spin_a) * dot(round_a, round_a))
    bend += sqrt(dot(seen.spin_b, seen.spin_b) * dot(round_b, round_b))
    left = near - points.gap
    # until then the accelerations take no more than half of what is left
    longest = sqrt(left / bend) if bend > 0.0 else np.inf
    time = min(longest, until_apart(apart, velocity, near))
    slack = 0.5 * bend * time * time if time < np.inf else 0.0
    return min(time, until_apart(apart, velocity, near - slack))


@kernel
def until_apart(apart: Vector, velocity: Vector, near: float) -> float:
    """When |apart + velocity t| = near, s, of points that are nearer now."""
    approach, square, speed = dot(apart, velocity), dot(apart, apart), dot(velocity, velocity)
    if speed == 0.0:
        return np.inf
    below = near * near - square
    root = sqrt(approach * approach + speed * below)
    return below / (root + approach) if approach > 0.0 else (root - approach) / speed
