"""Which of two surfaces that do not touch is inside the other: overlapping as bodies, but no hit, since a mesh is a
surface. Such pairs are counted apart."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi, sqrt

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.kernel import kernel
from harness.narrowphase.placement import Placement, pose_of
from harness.narrowphase.vectors import Vector, cross, dot, minus, plus, scaled, turned
from harness.scene.mesh import Mesh


class Containment:
    """Finds the contained among pairs of bodies of different sizes.

    Parameters
    ----------
    meshes : that there are
    mesh_of : (n,) int array, the number of each body's mesh
    """

    def __init__(self, meshes: Sequence[Mesh], mesh_of: Ints) -> None:
        self._witnesses = [_witnesses(mesh) for mesh in meshes]
        self._corners = [np.ascontiguousarray(mesh.vertices[mesh.faces]) for mesh in meshes]
        self._mesh_of = mesh_of.tolist()

    def contained(self, pairs: Pairs, placement: Placement) -> Pairs:
        """Those of the pairs, (k, 2), none of which touch, in which one body is wholly inside the other."""
        sizes = placement.sizes
        inside = [self._inside(placement, *((i, j) if sizes[i] > sizes[j] else (j, i))) for i, j in pairs.tolist()]
        return pairs[np.array(inside, np.bool_)]

    def _inside(self, placement: Placement, outer: int, inner: int) -> bool:
        witnesses, corners = self._witnesses[self._mesh_of[inner]], self._corners[self._mesh_of[outer]]
        return inside_of(placement, outer, inner, witnesses, corners)


def _witnesses(mesh: Mesh) -> Floats:
    """A point of each piece of a surface: a piece that touches nothing is inside if one of its points is."""
    from scipy.sparse import coo_array  # only runs with meshes of different sizes need it
    from scipy.sparse.csgraph import connected_components

    ends = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(len(mesh.vertices),) * 2)
    _, piece = connected_components(graph, directed=False)
    return mesh.vertices[np.unique(piece, return_index=True)[1]]


@kernel
def inside_of(placement: Placement, outer: int, inner: int, witnesses: Floats, corners: Floats) -> bool:
    """Whether all witnesses, (w, 3), of the inner body are inside the surface, (f, 3, 3), of the outer one."""
    pose = pose_of(placement, outer, inner)
    for k in range(len(witnesses)):
        place = turned(pose.rotation, (witnesses[k, 0], witnesses[k, 1], witnesses[k, 2]))
        point = scaled(plus(pose.offset, scaled(place, pose.size_b)), 1.0 / pose.size_a)
        if dot(point, point) > 0.25 or abs(winding(point, corners)) < 0.5:
            return False
    return True


@kernel
def winding(point: Vector, corners: Floats) -> float:
    """How often a surface goes around a point, as a share of the full solid angle (Van Oosterom and Strackee, 1983).

    A fraction near 0 or 1 where the surface has a small hole, so that open meshes have an inside too.
    """
    total = 0.0
    for f in range(len(corners)):
        a = minus((corners[f, 0, 0], corners[f, 0, 1], corners[f, 0, 2]), point)
        b = minus((corners[f, 1, 0], corners[f, 1, 1], corners[f, 1, 2]), point)
        c = minus((corners[f, 2, 0], corners[f, 2, 1], corners[f, 2, 2]), point)
        la, lb, lc = sqrt(dot(a, a)), sqrt(dot(b, b)), sqrt(dot(c, c))
        total += atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    return total / (2.0 * pi)
