"""Which surface a body has, for kernels that measure gaps of bodies of one mesh or of several; as `body_shapes`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import first_or_call, instruction
from harness.narrowphase.body_shapes import MeshShapes, begins_of, shape_of, shapes_of_bodies
from harness.narrowphase.gap import MeshGapShape
from harness.narrowphase.triangle_blocks import TriangleBlocks


class BlocksOfMeshes(NamedTuple):
    """The blocks of several meshes.

    Attributes
    ----------
    first, counts, leaves : those of each TriangleBlocks, one after another
    balls, corners : (4 f,) and (9 f,) float arrays, those of each, whose rows stand one after another
    begins : (m + 1, 4) int array, where the nodes, triangles, balls and corners of each mesh begin
    mesh_of : (n,) int array, the number of each body's mesh
    """

    first: Ints
    counts: Ints
    leaves: Ints
    balls: Floats
    corners: Floats
    begins: Ints
    mesh_of: Ints


class MeshGapShapes(NamedTuple):
    """The surfaces of several meshes, as searches for nearest points see them."""

    meshes: MeshShapes
    blocks: BlocksOfMeshes


GapShapes = MeshGapShape | MeshGapShapes


def gap_shapes_of_bodies(shapes: Sequence[MeshGapShape], mesh_of: Ints) -> GapShapes:
    """The surfaces that a kernel picks from: the one there is, or all of them.

    Parameters
    ----------
    shapes : of each mesh
    mesh_of : (n,) int array, the number of each body's mesh
    """
    meshes = shapes_of_bodies([shape.mesh for shape in shapes], mesh_of)
    if not isinstance(meshes, MeshShapes):
        return shapes[0]
    flat = [
        (blocks.first, blocks.leaves, blocks.balls.ravel(), blocks.corners.ravel())
        for blocks in (shape.blocks for shape in shapes)
    ]
    first, leaves, balls, corners = (np.concatenate(arrays) for arrays in zip(*flat, strict=True))
    counts = np.concatenate([shape.blocks.counts for shape in shapes])
    blocks = BlocksOfMeshes(first, counts, leaves, balls, corners, begins_of(flat), mesh_of)
    return MeshGapShapes(meshes, blocks)


def _among(shapes: Any, body: int) -> Any:
    blocks = shapes.blocks
    mesh = blocks.mesh_of[body]
    here, end = blocks.begins[mesh], blocks.begins[mesh + 1]
    faces = end[1] - here[1]
    return MeshGapShape(
        shape_of(shapes.meshes, body),
        TriangleBlocks(
            blocks.first[here[0] : end[0]],
            blocks.counts[here[0] : end[0]],
            blocks.leaves[here[1] : end[1]],
            blocks.balls[here[2] : end[2]].reshape(4, faces),
            blocks.corners[here[3] : end[3]].reshape(9, faces),
        ),
    )


def _gap_shape_of(context: Any, shapes: Any, body: Any) -> Any:
    return first_or_call(context, _among if shapes.instance_class is MeshGapShapes else None, shapes, body)


gap_shape_of = cast(Callable[[GapShapes, int], MeshGapShape], instruction(_gap_shape_of))
"""The surface of a body, in kernels."""
