"""The gap of two bodies and their nearest points, for spheres, hulls and surfaces.

Of spheres and hulls the gap is that of solids, 0 where they overlap; of meshes it is that of their surfaces, of which
one may be inside the other. Lengths are in any one unit; points are counted from the centre of body a, in its axes.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from harness.kernel import kernel, strict_step
from harness.narrowphase.gjk import Relative, WarmStart, difference, hull_distance, vertex_a, vertex_b
from harness.narrowphase.mesh_advancement import MeshShape, MeshWarmStart, mesh_shape
from harness.narrowphase.simplex import Simplex
from harness.narrowphase.support import SupportMap
from harness.narrowphase.surface_gap import Blocks, SearchScratch, surface_gap
from harness.narrowphase.tree_pairs import Trees
from harness.narrowphase.triangle_blocks import TriangleBlocks, block_triangle_a, block_triangle_b, triangle_blocks
from harness.narrowphase.triangle_distance import walk
from harness.narrowphase.vectors import Vector, dot, plus, scaled, unit
from harness.narrowphase.witness import nearest_weights
from harness.scene.mesh import Mesh

# Of the sum of the sizes: a gap that cannot be told from 0, some roundings of a coordinate.
TOUCHING = 1e-15
# Of the sum of the sizes: how well the gap of the hulls is known before the surfaces are searched.
HULL_TOLERANCE = 1e-3

NOWHERE: Vector = (np.nan, np.nan, np.nan)


class Gap(NamedTuple):
    """How far two bodies are apart.

    Attributes
    ----------
    lower, upper : bounds on the gap, up to rounding of 1e-15 of the sizes and of the distance; 0 where the bodies
        touch, inf where they are certainly farther apart than a limit
    point_a, point_b : points of the bodies that are `upper` apart; the same one where they touch, nan beyond a limit
    """

    lower: float
    upper: float
    point_a: Vector
    point_b: Vector


BEYOND = Gap(np.inf, np.inf, NOWHERE, NOWHERE)


class Accuracy(NamedTuple):
    """How well a gap is to be known.

    Attributes
    ----------
    limit : beyond which it does not matter
    enough : a gap that need not be known better
    tolerance : by how much the two bounds may differ
    """

    limit: float
    enough: float
    tolerance: float


EXACT = Accuracy(np.inf, 0.0, 0.0)


class MeshGapShape(NamedTuple):
    """A surface of diameter 1, as searches for nearest points see it.

    Attributes
    ----------
    mesh : MeshShape
    blocks : TriangleBlocks of its tree
    """

    mesh: MeshShape
    blocks: TriangleBlocks


def mesh_gap_shape(mesh: Mesh) -> MeshGapShape:
    """The surface and the hull of a mesh, made ready for searches."""
    shape = mesh_shape(mesh)
    return MeshGapShape(shape, triangle_blocks(shape.tree))


@kernel
def sphere_gap(offset: Vector, radius_a: float, radius_b: float) -> Gap:
    """The gap of two spheres; the offset is from a's centre to b's. The points are in the axes of the offset."""
    distance = sqrt(dot(offset, offset))
    towards = (1.0, 0.0, 0.0)
    if distance > 0.0:
        towards = offset[0] / distance, offset[1] / distance, offset[2] / distance
    gap = distance - (radius_a + radius_b)
    if gap > 0.0:
        return Gap(gap, gap, scaled(towards, radius_a), scaled(towards, distance - radius_b))
    # the middle of what both cut out of the line through their centres
    middle = 0.5 * (max(-radius_a, distance - radius_b) + min(radius_a, distance + radius_b))
    return Gap(0.0, 0.0, scaled(towards, middle), scaled(towards, middle))


@kernel
def hull_gap(
    hull_a: SupportMap, hull_b: SupportMap, pose: Relative, start: WarmStart, axis: Vector, accuracy: Accuracy
) -> tuple[Gap, Vector, WarmStart]:
    """The gap of two hulls.

    Parameters
    ----------
    hull_a, hull_b : SupportMap
    pose : Relative
    start, axis : as `gjk.hull_distance` has them
    accuracy : Accuracy

    Returns
    -------
    The gap, an axis from b to a along which the hulls are at least its lower bound apart, and the start of the next
    search of this pair.
    """
    touching = TOUCHING * (pose.size_a + pose.size_b)
    margin = max(touching, accuracy.enough)
    found = hull_distance(hull_a, hull_b, pose, start, axis, margin, accuracy.limit, accuracy.tolerance)
    if found.lower > accuracy.limit:
        return BEYOND, found.axis, found.warm_start
    s0, s1, s2, s3 = found.warm_start
    size = 1 if s1 < 0 else (2 if s2 < 0 else (3 if s3 < 0 else 4))
    p0 = difference(hull_a, hull_b, pose, s0)
    p1 = difference(hull_a, hull_b, pose, s1) if size > 1 else p0
    p2 = difference(hull_a, hull_b, pose, s2) if size > 2 else p0
    p3 = difference(hull_a, hull_b, pose, s3) if size > 3 else p0
    simplex, shares = nearest_weights(Simplex(p0, p1, p2, p3, found.warm_start, size))
    point_a = point_b = (0.0, 0.0, 0.0)
    for corner in range(simplex.size):
        vertices, share = simplex.vertices[corner], shares[corner]
        point_a = plus(point_a, scaled(vertex_a(hull_a, pose, vertices >> 32), share))
        point_b = plus(point_b, scaled(vertex_b(hull_b, pose, vertices & 0xFFFFFFFF), share))
    return between(found.lower, found.upper, point_a, point_b, touching), found.axis, found.warm_start


@kernel
def mesh_gap(
    shape_a: MeshGapShape,
    shape_b: MeshGapShape,
    pose: Relative,
    start: MeshWarmStart,
    accuracy: Accuracy,
    scratch: SearchScratch,
) -> tuple[Gap, MeshWarmStart]:
    """The gap of two surfaces.

    Parameters
    ----------
    shape_a, shape_b : MeshGapShape
    pose : Relative
    start : MeshWarmStart of an earlier search for this pair, or MESH_COLD_START
    accuracy : Accuracy
    scratch : written

    Returns
    -------
    The gap, and the start of the next search of this pair.
    """
    sizes = pose.size_a + pose.size_b
    touching, away = TOUCHING * sizes, scaled(pose.offset, -1.0)
    tolerance = max(accuracy.tolerance, HULL_TOLERANCE * sizes)
    hull_a, hull_b = shape_a.mesh.hull, shape_b.mesh.hull
    hulls = hull_distance(hull_a, hull_b, pose, start.hulls, away, touching, accuracy.limit, tolerance)
    if hulls.lower > accuracy.limit:
        return BEYOND, MeshWarmStart(hulls.warm_start, start.leaves)
    axis = unit(hulls.axis if hulls.lower > 0.0 else away)
    if axis == (0.0, 0.0, 0.0):
        axis = (1.0, 0.0, 0.0)
    trees, blocks = Trees(shape_a.mesh.tree, shape_b.mesh.tree), Blocks(shape_a.blocks, shape_b.blocks)
    enough = max(touching, accuracy.enough)
    found = surface_gap(trees, blocks, pose, start.leaves, axis, accuracy.limit, enough, accuracy.tolerance, scratch)
    if found.leaves.a < 0:
        return BEYOND, MeshWarmStart(hulls.warm_start, start.leaves)
    i, j = blocks.a.first[found.leaves.a], blocks.b.first[found.leaves.b]
    one, other = block_triangle_a(blocks.a, pose, i), block_triangle_b(blocks.b, pose, j)
    simplex, shares = nearest_weights(walk(one, other, found.axis, touching, np.inf).simplex)
    point_a = point_b = (0.0, 0.0, 0.0)
    for corner in range(simplex.size):
        corners, share = simplex.vertices[corner], shares[corner]
        point_a = plus(point_a, scaled(one[corners // 3], share))
        point_b = plus(point_b, scaled(other[corners % 3], share))
    gap = between(max(found.lower, hulls.lower), found.gap, point_a, point_b, touching)
    return gap, MeshWarmStart(hulls.warm_start, found.leaves)


@strict_step
def between(lower: float, upper: float, point_a: Vector, point_b: Vector, touching: float) -> Gap:
    """The gap between two points, which are made one where it cannot be told from 0."""
    if upper > touching:
        return Gap(min(lower, upper), upper, point_a, point_b)
    middle = scaled(plus(point_a, point_b), 0.5)
    return Gap(0.0, 0.0, middle, middle)
