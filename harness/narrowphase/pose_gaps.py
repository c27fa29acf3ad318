"""Gaps of two bodies at many poses, one after the other in one kernel; each as if it were the only one."""

from __future__ import annotations

from typing import NamedTuple

from harness.arrays import Floats
from harness.kernel import kernel, strict_step
from harness.narrowphase.gap import Accuracy, Gap, MeshGapShape, hull_gap, mesh_gap, sphere_gap
from harness.narrowphase.gjk import COLD_START, Relative, relative_pose
from harness.narrowphase.mesh_advancement import MESH_COLD_START
from harness.narrowphase.support import SupportMap
from harness.narrowphase.surface_gap import search_scratch
from harness.narrowphase.vectors import Matrix, Vector, minus, plus, rotation, scaled, turned


class Poses(NamedTuple):
    """Where a body is, again and again.

    Attributes
    ----------
    positions : (n, 3) float array, of the centre, m
    quaternions : (n, 4) float array, unit, w x y z
    size : m
    """

    positions: Floats
    quaternions: Floats
    size: float


class Gaps(NamedTuple):
    """What is found, written.

    Attributes
    ----------
    gaps : (n,) float array, m; inf beyond the limit
    points : (n, 2, 3) float array, m, in the world, of body a and of body b; nan beyond the limit
    """

    gaps: Floats
    points: Floats


@kernel
def sphere_gaps(a: Poses, b: Poses, accuracy: Accuracy, found: Gaps) -> None:
    """The gaps of two spheres, of which the sizes are the diameters."""
    straight = rotation(1.0, 0.0, 0.0, 0.0)
    for k in range(len(a.positions)):
        gap = sphere_gap(minus(position(b, k), position(a, k)), 0.5 * a.size, 0.5 * b.size)
        write(found, k, gap, straight, position(a, k))


@kernel
def hull_gaps(hull_a: SupportMap, hull_b: SupportMap, a: Poses, b: Poses, accuracy: Accuracy, found: Gaps) -> None:
    """The gaps of two hulls."""
    for k in range(len(a.positions)):
        pose = pose_at(a, b, k)
        gap, _, _ = hull_gap(hull_a, hull_b, pose, COLD_START, scaled(pose.offset, -1.0), accuracy)
        write(found, k, gap, turn(a, k), position(a, k))


@kernel
def mesh_gaps(
    shape_a: MeshGapShape, shape_b: MeshGapShape, a: Poses, b: Poses, accuracy: Accuracy, found: Gaps
) -> None:
    """The gaps of two surfaces."""
    scratch = search_scratch()
    for k in range(len(a.positions)):
        gap, _ = mesh_gap(shape_a, shape_b, pose_at(a, b, k), MESH_COLD_START, accuracy, scratch)
        write(found, k, gap, turn(a, k), position(a, k))


@strict_step
def pose_at(a: Poses, b: Poses, k: int) -> Relative:
    """The k-th pose of body b as seen from body a."""
    return relative_pose(turn(a, k), a.size, turn(b, k), b.size, minus(position(b, k), position(a, k)))


@strict_step
def position(body: Poses, k: int) -> Vector:
    x = body.positions
    return x[k, 0], x[k, 1], x[k, 2]


@strict_step
def turn(body: Poses, k: int) -> Matrix:
    q = body.quaternions
    return rotation(q[k, 0], q[k, 1], q[k, 2], q[k, 3])


@strict_step
def write(found: Gaps, k: int, gap: Gap, turn_a: Matrix, position_a: Vector) -> None:
    found.gaps[k] = gap.upper
    point_a, point_b = plus(position_a, turned(turn_a, gap.point_a)), plus(position_a, turned(turn_a, gap.point_b))
    found.points[k, 0, 0], found.points[k, 0, 1], found.points[k, 0, 2] = point_a
    found.points[k, 1, 0], found.points[k, 1, 1], found.points[k, 1, 2] = point_b
