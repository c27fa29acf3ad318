"""Conservative advancement of surfaces, convex or not: when two bodies of triangles in free flight touch.

Each pair of parts, a node of either tree of discs, has a clock of its own: the time until which it is proved not to
touch. The pair whose clock is earliest is looked at next, where the bodies are then: parts are replaced by their
halves, and triangles advanced by what their distance allows. Nothing touches before the earliest clock; it shows the
time of impact when it is that of two triangles a tolerance apart, and that nothing touches when none is left. A bound
proves this for every pair of parts by itself, so that ribs and hollows need no rule of their own.

The hulls go first: while they do not touch, nothing inside them does.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import inner, kernel
from harness.narrowphase.advancement import (
    IMPACT,
    NEVER,
    STALLED,
    Motion,
    attitude,
    orientation,
    place,
    time_of_impact,
)
from harness.narrowphase.crossing import DEPTH
from harness.narrowphase.gjk import MARGIN, NO_SEEDS, Seeds
from harness.narrowphase.motion_bounds import moving_disc, triangle_of, until_discs_touch, until_triangles_touch
from harness.narrowphase.support import SupportMap, support_map
from harness.narrowphase.triangle_distance import triangle_distance
from harness.narrowphase.triangle_tree import TriangleTree, triangle_tree
from harness.narrowphase.vectors import Vector, dot, minus, plus, scaled
from harness.scene.mesh import Mesh

# Pairs of parts looked at, after which a search is given up where it stands. Ordinary ones take 100 to 1000.
MOST_STEPS = 200_000

# Of the sum of the sizes: how near the hulls need be brought before the surfaces are searched.
HULL_TOLERANCE = 1e-3


class MeshShape(NamedTuple):
    """A surface of diameter 1, as searches see it.

    Attributes
    ----------
    hull : SupportMap of its convex hull
    tree : TriangleTree
    radius : of a sphere around the centre that holds it
    """

    hull: SupportMap
    tree: TriangleTree
    radius: float


class Start(NamedTuple):
    """Where to begin the next search of a pair; it only saves time.

    Attributes
    ----------
    seeds : of the search on the hulls
    leaves : of either tree, that of the nearest triangles; -1 if not known
    """

    seeds: Seeds
    leaves: tuple[int, int]


NO_START = Start(NO_SEEDS, (-1, -1))


class MeshImpact(NamedTuple):
    """What a search has found.

    Attributes
    ----------
    verdict : IMPACT; NEVER, if nothing touches until the end of the window; STALLED, if it was given up
    time : s, before which nothing touches; of the impact, if there is one, else the end of the window or inf
    gap : m, between the nearest triangles at an impact, else 0
    axis : of the gap, pointing away from the second body, in the world; a unit vector, or zero if they cross
    start : for the next search of this pair
    steps : pairs of parts looked at, and distances of hulls measured
    """

    verdict: int
    time: float
    gap: float
    axis: Vector
    start: Start
    steps: int


def mesh_shape(mesh: Mesh) -> MeshShape:
    """The surface and the hull of a mesh, made ready for searches."""
    radius = float(np.sqrt(np.square(mesh.vertices).sum(axis=1).max()))
    return MeshShape(support_map(mesh.hull.vertices), triangle_tree(mesh.vertices, mesh.faces), radius)


@kernel
def time_of_mesh_impact(
    shape_a: MeshShape,
    shape_b: MeshShape,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    start: Start,
) -> MeshImpact:
    """When two surfaces come within a tolerance of each other.

    Parameters
    ----------
    shape_a, shape_b : MeshShape
    a, b : Motion
    begin, end : s, the window; the end may be inf
    tolerance : m, the gap at which surfaces count as touching
    start : of an earlier search for this pair, or NO_START

    Returns
    -------
    MeshImpact
        At a time not after the true first contact, and at which the surfaces are no farther apart than the tolerance.
        Of surfaces that cross at the beginning, at the beginning. A surface wholly inside the other does not touch it.
        Surfaces that come within the tolerance, but do not touch, may be found to or not.
    """
    margin = MARGIN * (a.size + b.size)
    reach = a.size * shape_a.radius + b.size * shape_b.radius + max(tolerance, margin)
    # times from here on are relative to where the spheres around the bodies first touch, so that no digit is lost
    entry, parting = meeting_of_spheres(a, b, begin, reach)
    never = np.inf if begin + parting < end else end
    rest = min(parting, end - begin) - entry
    if not rest >= 0.0:
        return MeshImpact(NEVER, never, 0.0, (0.0, 0.0, 0.0), start, 0)
    a, b = seen_at(a, b, begin + entry)
    coarse = max(tolerance, HULL_TOLERANCE * (a.size + b.size))
    hulls = time_of_impact(shape_a.hull, shape_b.hull, a, b, 0.0, rest, coarse, start.seeds)
    if hulls.verdict == NEVER:
        never = max(never, hulls.time)  # which is inf if they never do
        return MeshImpact(NEVER, never, 0.0, hulls.axis, Start(hulls.seeds, start.leaves), hulls.steps)
    verdict, time, gap, axis, leaves, steps = first_touch(
        shape_a.tree, shape_b.tree, a, b, hulls.time, rest, tolerance, margin
    )
    time = never if verdict == NEVER else min(end, begin + (entry + time))
    return MeshImpact(verdict, time, gap, axis, Start(hulls.seeds, leaves), hulls.steps + steps)


@kernel
def meeting_of_spheres(a: Motion, b: Motion, begin: float, reach: float) -> tuple[float, float]:
    """When the centres come nearer than a reach, and when they part for good, s after the beginning.

    If they do not meet, the parting comes first: it is -inf.
    """
    offset, velocity = minus(place(b, begin), place(a, begin)), minus(b.velocity, a.velocity)
    outside = dot(offset, offset) - reach * reach
    approach, speed = dot(offset, velocity), dot(velocity, velocity)
    if outside > 0.0 and approach >= 0.0:
        return 0.0, -np.inf
    if speed == 0.0:
        return 0.0, np.inf
    # the distance at which the centres pass, by the part of the offset across the path: exact from far away
    nearest = minus(offset, scaled(velocity, approach / speed))
    inside = reach * reach - dot(nearest, nearest)
    if inside < 0.0:
        return 0.0, -np.inf
    half, middle = sqrt(inside / speed), -approach / speed
    return middle - half if outside > 0.0 else 0.0, middle + half


@kernel
def seen_at(a: Motion, b: Motion, time: float) -> tuple[Motion, Motion]:
    """The bodies as seen from the centre of the first, which moves with it, and with this time as 0."""
    offset, velocity, rest = minus(place(b, time), place(a, time)), minus(b.velocity, a.velocity), (0.0, 0.0, 0.0)
    return (
        Motion(rest, rest, attitude(a, time), a.spin, a.size, a.reach),
        Motion(offset, velocity, attitude(b, time), b.spin, b.size, b.reach),
    )


@kernel
def first_touch(
    tree_a: TriangleTree,
    tree_b: TriangleTree,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    tolerance: float,
    margin: float,
) -> tuple[int, float, float, Vector, tuple[int, int], int]:
    """Search the trees of two bodies as `seen_at` gives them; returns what MeshImpact holds."""
    # Steps end a little before contact, where the axis of the gap can still be told from rounding.
    near = max(tolerance, 8.0 * margin)
    aim = near / 4.0
    rates = sqrt(dot(a.spin, a.spin)), sqrt(dot(b.spin, b.spin))
    stack = np.empty((DEPTH, 2), np.int64)
    clocks, pairs = np.empty(64), np.empty(64, np.int64)
    verdict, until, gap, axis, leaves = NEVER, end, 0.0, (0.0, 0.0, 0.0), (-1, -1)
    clocks[0], pairs[0] = begin, 0
    waiting, steps = 1, 0
    while waiting > 0 and clocks[0] < until:
        now, pair = clocks[0], pairs[0]
        waiting -= 1
        sink(clocks, pairs, waiting, clocks[waiting], pairs[waiting])
        turn_a, turn_b = orientation(a, now), orientation(b, now)
        offset = plus(b.position, scaled(b.velocity, now))
        stack[0, 0], stack[0, 1] = pair >> 32, pair & 0xFFFFFFFF
        height = 1
        while height > 0:
            if steps >= MOST_STEPS:
                return STALLED, now, gap, axis, leaves, steps
            steps += 1
            height -= 1
            node_a, node_b = stack[height, 0], stack[height, 1]
            right_a, right_b = tree_a.right[node_a], tree_b.right[node_b]
            if right_a < 0 and right_b < 0:
                found = impact_of_triangles(
                    tree_a, tree_b, -1 - right_a, -1 - right_b, a, b, now, until, near, aim, margin
                )
                steps += found[4]
                if found[0] == STALLED:
                    return STALLED, now, found[2], found[3], (node_a, node_b), steps
                if found[0] == IMPACT:
                    verdict, until, gap, axis, leaves = IMPACT, found[1], found[2], found[3], (node_a, node_b)
                    if until <= now:
                        return verdict, until, gap, axis, leaves, steps
                continue
            larger_a = right_a >= 0 and tree_a.discs[node_a, 3] * a.size >= tree_b.discs[node_b, 3] * b.size
            if right_b < 0 or larger_a:
                a0, b0, a1, b1 = node_a + 1, node_b, right_a, node_b
                disc_b = moving_disc(tree_b, node_b, turn_b, b)
                disc_a = moving_disc(tree_a, a0, turn_a, a)
                wait0, depth0 = until_discs_touch(disc_a, disc_b, offset, a, b, rates, aim, until - now)
                disc_a = moving_disc(tree_a, a1, turn_a, a)
                wait1, depth1 = until_discs_touch(disc_a, disc_b, offset, a, b, rates, aim, until - now)
            else:
                a0, b0, a1, b1 = node_a, node_b + 1, node_a, right_b
                disc_a = moving_disc(tree_a, node_a, turn_a, a)
                disc_b = moving_disc(tree_b, b0, turn_b, b)
                wait0, depth0 = until_discs_touch(disc_a, disc_b, offset, a, b, rates, aim, until - now)
                disc_b = moving_disc(tree_b, b1, turn_b, b)
                wait1, depth1 = until_discs_touch(disc_a, disc_b, offset, a, b, rates, aim, until - now)
            if depth0 > depth1:  # the deeper one goes on top
                a0, b0, wait0, a1, b1, wait1 = a1, b1, wait1, a0, b0, wait0
            if wait1 == 0.0:
                stack[height, 0], stack[height, 1] = a1, b1
                height += 1
            elif wait1 < np.inf:
                if waiting == len(clocks):
                    clocks, pairs = doubled(clocks), doubled_numbers(pairs)
                rise(clocks, pairs, waiting, now + wait1, a1 << 32 | b1)
                waiting += 1
            if wait0 == 0.0:
                stack[height, 0], stack[height, 1] = a0, b0
                height += 1
            elif wait0 < np.inf:
                if waiting == len(clocks):
                    clocks, pairs = doubled(clocks), doubled_numbers(pairs)
                rise(clocks, pairs, waiting, now + wait0, a0 << 32 | b0)
                waiting += 1
    return verdict, until, gap, axis, leaves, steps


@kernel
def impact_of_triangles(
    tree_a: TriangleTree,
    tree_b: TriangleTree,
    triangle_a: int,
    triangle_b: int,
    a: Motion,
    b: Motion,
    begin: float,
    end: float,
    near: float,
    aim: float,
    margin: float,
) -> tuple[int, float, float, Vector, int]:
    """When one pair of triangles touches: verdict, time, gap, axis, and steps."""
    now = begin
    for step in range(1, MOST_STEPS):
        turn_a, turn_b = orientation(a, now), orientation(b, now)
        offset = plus(b.position, scaled(b.velocity, now))
        one = triangle_of(tree_a, triangle_a, turn_a, a.size)
        arms = triangle_of(tree_b, triangle_b, turn_b, b.size)
        other = plus(offset, arms[0]), plus(offset, arms[1]), plus(offset, arms[2])
        found = triangle_distance(one, other, margin)
        if found.upper <= near or found.lower <= margin:
            return IMPACT, now, found.upper, found.axis, step
        wait = until_triangles_touch(one, other, found.axis, offset, a, b, aim, end - now)
        if wait == np.inf:
            return NEVER, end, found.upper, found.axis, step
        if not now + wait > now:
            return STALLED, now, found.upper, found.axis, step
        now += wait
    return STALLED, now, 0.0, (0.0, 0.0, 0.0), MOST_STEPS


@inner
def sink(clocks: Floats, pairs: Ints, count: int, clock: float, pair: int) -> None:
    """Put an entry in the place of the first of a heap, whose earliest comes first."""
    place = 0
    while 2 * place + 1 < count:
        child = 2 * place + 1
        if child + 1 < count and clocks[child + 1] < clocks[child]:
            child += 1
        if clocks[child] >= clock:
            break
        clocks[place], pairs[place] = clocks[child], pairs[child]
        place = child
    clocks[place], pairs[place] = clock, pair


@inner
def rise(clocks: Floats, pairs: Ints, place: int, clock: float, pair: int) -> None:
    """Put an entry behind the last of a heap."""
    while place > 0:
        parent = (place - 1) // 2
        if clocks[parent] <= clock:
            break
        clocks[place], pairs[place] = clocks[parent], pairs[parent]
        place = parent
    clocks[place], pairs[place] = clock, pair


@kernel
def doubled(values: Floats) -> Floats:
    """The same in twice the room."""
    longer = np.empty(2 * len(values))
    longer[: len(values)] = values
    return longer


@kernel
def doubled_numbers(values: Ints) -> Ints:
    """The same in twice the room."""
    longer = np.empty(2 * len(values), np.int64)
    longer[: len(values)] = values
    return longer
