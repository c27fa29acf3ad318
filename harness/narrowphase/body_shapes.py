"""Which hull, which tree of triangles a body has, for kernels over bodies of one mesh or of several.

Bodies of one mesh share its structure, and a kernel is given just that: then `hull_of`, `tree_of` and `shape_of` are
the identity, decided when the kernel is compiled, so that a scene of one mesh costs nothing more. The structures of
several meshes stand one after another in single arrays, of which a body's are a slice.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats, Ints
from harness.kernel import first_or_call, instruction
from harness.narrowphase.clearance_field import ClearanceField
from harness.narrowphase.mesh_advancement import MeshShape
from harness.narrowphase.support import SupportMap
from harness.narrowphase.triangle_tree import TriangleTree


class SupportMaps(NamedTuple):
    """The support maps of several meshes.

    Attributes
    ----------
    vertices, start, candidates : those of each SupportMap, one after another
    begins : (m + 1, 3) int array, where those of each mesh begin
    sides : (m,) int array
    mesh_of : (n,) int array, the number of each body's mesh
    """

    vertices: Floats
    start: NDArray[np.int32]
    candidates: NDArray[np.int32]
    begins: Ints
    sides: Ints
    mesh_of: Ints


class TriangleTrees(NamedTuple):
    """The trees of several meshes.

    Attributes
    ----------
    discs, right, parent, corners : those of each TriangleTree, one after another
    begins : (m + 1, 2) int array, where the nodes and the triangles of each mesh begin
    mesh_of : (n,) int array, the number of each body's mesh
    """

    discs: Floats
    right: Ints
    parent: Ints
    corners: Floats
    begins: Ints
    mesh_of: Ints


class ClearanceFields(NamedTuple):
    """The fields of several meshes.

    Attributes
    ----------
    values : (m, n, n, n) float32 array, of a mesh without a field 0
    points, caps : those of each ClearanceField, one after another
    begins : (m + 1, 2) int array, where those of each mesh begin
    """

    values: NDArray[np.float32]
    points: Floats
    caps: Floats
    begins: Ints


class MeshShapes(NamedTuple):
    """The surfaces of several meshes; `radius` is that of a sphere around the centre that holds any of them."""

    hulls: SupportMaps
    trees: TriangleTrees
    radius: float
    fields: ClearanceFields


Hulls = SupportMap | SupportMaps
Surfaces = TriangleTree | TriangleTrees
Shapes = MeshShape | MeshShapes


def hulls_of_bodies(maps: Sequence[SupportMap], mesh_of: Ints) -> Hulls:
    """The hulls that a kernel picks from: the one there is, or all of them.

    Parameters
    ----------
    maps : of each mesh
    mesh_of : (n,) int array, the number of each body's mesh
    """
    if len(maps) == 1:
        return maps[0]
    parts = [(one.vertices, one.start, one.candidates) for one in maps]
    vertices, start, candidates = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    sides = np.array([one.side for one in maps], np.int64)
    return SupportMaps(vertices, start, candidates, begins_of(parts), sides, mesh_of)


def trees_of_bodies(trees: Sequence[TriangleTree], mesh_of: Ints) -> Surfaces:
    """The trees that a kernel picks from; parameters as for `hulls_of_bodies`."""
    if len(trees) == 1:
        return trees[0]
    discs, right, parent, corners = (np.concatenate(arrays) for arrays in zip(*trees, strict=True))
    begins = begins_of([(tree.discs, tree.corners) for tree in trees])
    return TriangleTrees(discs, right, parent, corners, begins, mesh_of)


def shapes_of_bodies(shapes: Sequence[MeshShape], mesh_of: Ints) -> Shapes:
    """The surfaces that a kernel picks from; parameters as for `hulls_of_bodies`."""
    hulls = hulls_of_bodies([one.hull for one in shapes], mesh_of)
    trees = trees_of_bodies([one.tree for one in shapes], mesh_of)
    if isinstance(hulls, SupportMap) or isinstance(trees, TriangleTree):
        return shapes[0]
    return MeshShapes(hulls, trees, max(one.radius for one in shapes), _fields([one.field for one in shapes]))


def _fields(fields: Sequence[ClearanceField]) -> ClearanceFields:
    nodes = max(len(field.values) for field in fields)
    values = np.zeros((len(fields), nodes, nodes, nodes), np.float32)
    for mesh, field in enumerate(fields):
        if len(field.values):
            values[mesh] = field.values
    parts = [(field.points, field.caps) for field in fields]
    points, caps = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return ClearanceFields(values, points, caps, begins_of(parts))


def begins_of(parts: Sequence[tuple[NDArray[Any], ...]]) -> Ints:
    """Where the arrays of each mesh begin, and where the last ones end."""
    lengths = np.array([[len(array) for array in arrays] for arrays in parts], np.int64)
    return np.concatenate([np.zeros((1, lengths.shape[1]), np.int64), np.cumsum(lengths, axis=0)])


def _hull_among(hulls: Any, body: int) -> Any:
    mesh = hulls.mesh_of[body]
    here, end = hulls.begins[mesh], hulls.begins[mesh + 1]
    return SupportMap(
        hulls.vertices[here[0] : end[0]],
        hulls.start[here[1] : end[1]],
        hulls.candidates[here[2] : end[2]],
        hulls.sides[mesh],
    )


def _tree_among(trees: Any, body: int) -> Any:
    mesh = trees.mesh_of[body]
    here, end = trees.begins[mesh], trees.begins[mesh + 1]
    return TriangleTree(
        trees.discs[here[0] : end[0]],
        trees.right[here[0] : end[0]],
        trees.parent[here[0] : end[0]],
        trees.corners[here[1] : end[1]],
    )


def _shape_among(shapes: Any, body: int) -> Any:
    fields, mesh = shapes.fields, shapes.hulls.mesh_of[body]
    here, end = fields.begins[mesh], fields.begins[mesh + 1]
    field = ClearanceField(fields.values[mesh], fields.points[here[0] : end[0]], fields.caps[here[1] : end[1]])
    return MeshShape(hull_of(shapes.hulls, body), tree_of(shapes.trees, body), shapes.radius, field)


def _hull_of(context: Any, hulls: Any, body: Any) -> Any:
    return first_or_call(context, _hull_among if hulls.instance_class is SupportMaps else None, hulls, body)


def _tree_of(context: Any, trees: Any, body: Any) -> Any:
    return first_or_call(context, _tree_among if trees.instance_class is TriangleTrees else None, trees, body)


def _shape_of(context: Any, shapes: Any, body: Any) -> Any:
    return first_or_call(context, _shape_among if shapes.instance_class is MeshShapes else None, shapes, body)


hull_of = cast(Callable[[Hulls, int], SupportMap], instruction(_hull_of))
"""The hull of a body, in kernels."""

tree_of = cast(Callable[[Surfaces, int], TriangleTree], instruction(_tree_of))
"""The tree of triangles of a body, in kernels."""

shape_of = cast(Callable[[Shapes, int], MeshShape], instruction(_shape_of))
"""The surface of a body, in kernels."""
