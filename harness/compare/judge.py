"""The judge between backends: whether two bodies touch, decided in exact arithmetic and proven.

It shares no code with any backend. Spheres are decided by their squared distance as a fraction, hulls by a common point
or a separating plane, meshes by the triangles that come near each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import sqrt

import numpy as np

from harness.arrays import Floats
from harness.compare import certificate
from harness.compare.certificate import Judgement, distance_along
from harness.compare.convex import CommonPoint, Plane, meet
from harness.compare.exact import PlacedPoints, Point, Points, world_points
from harness.compare.surfaces import judge_surfaces
from harness.scene.mesh import Triangles
from harness.scene.scene import Scene

# Steps towards the penetration depth; each that helps comes strictly nearer, most overlaps need two or three.
_MOST_STEPS = 10
# Unit vectors to the corners of a regular tetrahedron, whose inscribed sphere has a third of the radius; and how
# far the sets are moved along them, of a depth.
_TETRAHEDRON, _TRIED = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0), 0.9
# Vertices that bound the width along a direction, and directions whose width is worked out at a time.
_FEW, _AT_ONCE = 60, 32


def judge(scene: Scene, i: int, j: int, positions: Floats, quaternions: Floats) -> Judgement:
    """Whether bodies i and j of a scene touch at these poses.

    Parameters
    ----------
    scene : Scene
    i, j : body numbers
    positions : (n, 3) float array, m
    quaternions : (n, 4) float array, w x y z
    """
    sizes = scene.bodies.sizes
    if scene.shape == "sphere":
        return _spheres(positions[i].tolist(), positions[j].tolist(), float(sizes[i]), float(sizes[j]))
    first, second = (scene.solid_of_body(body) for body in (i, j))
    if scene.shape == "mesh":
        return judge_surfaces(first, positions[i], quaternions[i], second, positions[j], quaternions[j])
    placed = PlacedPoints(first.vertices, positions[i], quaternions[i])
    other = PlacedPoints(second.vertices, positions[j], quaternions[j])
    return _hulls(placed, first.faces, other, second.faces)


def touches(scene: Scene, i: int, j: int, positions: Floats, quaternions: Floats) -> bool:
    """Whether bodies i and j touch, as `judge` decides, without gap and proof: of hulls a few times quicker."""
    if scene.shape != "hull":
        return judge(scene, i, j, positions, quaternions).touching
    first, second = (scene.solid_of_body(body).vertices for body in (i, j))
    one, other, _ = world_points(
        PlacedPoints(first, positions[i], quaternions[i]), PlacedPoints(second, positions[j], quaternions[j])
    )
    found = meet(one, other)
    if not found.holds(one, other):
        raise ArithmeticError("a certificate does not hold")
    return isinstance(found, CommonPoint)


def _spheres(first: Sequence[float], second: Sequence[float], size: float, other_size: float) -> Judgement:
    squared = sum(((Fraction(b) - Fraction(a)) ** 2 for a, b in zip(first, second, strict=True)), Fraction(0))
    reach = (Fraction(size) + Fraction(other_size)) / 2
    excess = squared - reach * reach
    gap = float(excess / (Fraction(sqrt(squared)) + reach))
    proof = {"kind": "squared distance less squared sum of radii", "exact": str(excess)}
    return Judgement(excess <= 0, gap, proof)


def _hulls(first: PlacedPoints, faces: Triangles, second: PlacedPoints, other_faces: Triangles) -> Judgement:
    one, other, unit = world_points(first, second)
    found = meet(one, other)
    if not found.holds(one, other):
        raise ArithmeticError("a certificate does not hold")
    if isinstance(found, Plane):
        return Judgement(False, distance_along(found, one, other, unit), certificate.of_plane(found, one, other))
    depth = _depth(one, faces, other, other_faces, unit)
    return Judgement(True, -depth, certificate.of_common_point(found, one, first.position.tolist(), unit))


def _depth(first: Points, faces: Triangles, second: Points, other_faces: Triangles, unit: Fraction) -> float:
    """The penetration depth, m: along the normals of all faces, then improved where edges give a shorter way."""
    one, other = first.rough, second.rough
    normals = np.vstack([-_normals(one, faces), _normals(other, other_faces)])
    depth, normal = _least_width(one, other, normals)
    extent = float(np.ptp(one, axis=0).max())
    for _ in range(_MOST_STEPS):
        # moved out along the best way so far, the sets lie apart, and their shortest connection is a better way
        way = normal * (depth + 1e-3 * extent)
        x, y, z = (round(Fraction(part) / unit) for part in way.tolist())
        apart = meet(first.shifted((x, y, z), way), second)
        if isinstance(apart, CommonPoint):
            break
        shorter = -distance_along(apart, first, second, unit)
        if shorter >= depth * (1 - 1e-12):
            break
        depth = shorter
        direction = np.array([float(part) for part in _shortened(apart.normal)])
        normal = direction / np.linalg.norm(direction)
    return _no_deeper_than_proven(max(depth, 0.0), first, second, unit)


def _no_deeper_than_proven(depth: float, first: Points, second: Points, unit: Fraction) -> float:
    """A depth (m) of which at least three tenths are proven; where edges cross, descent from faces may end too deep.

    Moved by less than their depth in any direction the sets still meet. Four that go to the corners of a tetrahedron
    prove, if they meet after each of them, that they are as deep as its inscribed sphere; a plane between them after
    one is a direction of less depth.
    """
    least = float(unit)
    while depth > least:
        for corner in _TETRAHEDRON:
            way = corner * (_TRIED * depth)
            x, y, z = (round(Fraction(part) / unit) for part in way.tolist())
            apart = meet(first.shifted((x, y, z), way), second)
            if not isinstance(apart, CommonPoint):
                depth = max(0.0, min(_TRIED * depth, -distance_along(apart, first, second, unit)))
                break
        else:
            break
    return depth


def _least_width(one: Floats, other: Floats, normals: Floats) -> tuple[float, Floats]:
    """How far one set must be moved to part from the other along the best of some directions, and that direction."""
    # of some vertices each, which is never more than of all: no direction is worth all whose bound is no better
    bounds = _widths(one[:: len(one) // _FEW + 1], other[:: len(other) // _FEW + 1], normals)
    order = np.argsort(bounds, kind="stable")
    least, best = np.inf, order[0]
    for start in range(0, len(order), _AT_ONCE):
        some = order[start : start + _AT_ONCE]
        if bounds[some[0]] >= least:
            break
        widths = _widths(one, other, normals[some])
        if widths.min() < least:
            least, best = float(widths.min()), some[widths.argmin()]
    return float(least), np.asarray(normals[best], np.float64)


def _shortened(point: Point) -> Point:
    """The same direction, to more digits than floats hold, in integers that they can hold."""
    excess = max(0, max(abs(part).bit_length() for part in point) - 100)
    return point[0] >> excess, point[1] >> excess, point[2] >> excess


def _widths(one: Floats, other: Floats, directions: Floats) -> Floats:
    """(k,): how far one set must be moved along each direction to part from the other."""
    return np.asarray(_along(other, directions).max(axis=0) - _along(one, directions).min(axis=0), np.float64)


def _along(points: Floats, directions: Floats) -> Floats:
    """(n, k): how far points lie along directions. Not by BLAS, whose threads wait longer than this takes."""
    return np.asarray(np.einsum("ij,kj->ik", points, directions), np.float64)


def _normals(points: Floats, faces: Triangles) -> Floats:
    """Unit outward normals of the faces that have one."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    flat = lengths[:, 0] == 0
    return np.asarray(normals[~flat] / lengths[~flat], np.float64)
