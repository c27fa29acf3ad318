"""Which walls of the box a body touches: its lowest and highest point along each axis against the planes.

The lowest and highest points are the support function of the convex hull (of the sphere) along the wall normals; a mesh
reaches exactly as far as its hull. A body that touches a plane or is beyond it touches the wall.
"""

from __future__ import annotations

from harness.arrays import Flags, Floats
from harness.kernel import kernel
from harness.narrowphase.body_shapes import Hulls, hull_of
from harness.narrowphase.support import support
from harness.narrowphase.vectors import dot, rotation, scaled


@kernel
def spheres_at_walls(positions: Floats, radii: Floats, half: Floats, touching: Flags) -> None:
    """Mark the walls that spheres touch.

    Parameters
    ----------
    positions : (n, 3) float array, m
    radii : (n,) float array, m
    half : (3,) float array, m
        Half the sides of the box, which is centred at the origin.
    touching : (n, 6) bool array
        Overwritten, in the order x-, x+, y-, y+, z-, z+.
    """
    for i in range(len(positions)):
        for axis in range(3):
            touching[i, 2 * axis] = positions[i, axis] - radii[i] <= -half[axis]
            touching[i, 2 * axis + 1] = positions[i, axis] + radii[i] >= half[axis]


@kernel
def hulls_at_walls(
    positions: Floats,
    quaternions: Floats,
    sizes: Floats,
    hulls: Hulls,
    half: Floats,
    cull: bool,
    touching: Flags,
) -> int:
    """Mark the walls that turned and scaled hulls touch.

    Parameters
    ----------
    positions : (n, 3) float array, m
    quaternions : (n, 4) float array, w x y z
    sizes : (n,) float array, m
        Diameters of the bounding spheres; the hulls themselves have diameter 1.
    hulls : SupportMap or SupportMaps
        Of hulls centred on their bounding spheres.
    half : (3,) float array, m
    cull : bool
        Put a hull only to the walls that its bounding sphere reaches. The answer is the same.
    touching : (n, 6) bool array
        Overwritten, in the order x-, x+, y-, y+, z-, z+.

    Returns
    -------
    int
        Bodies whose hull was looked at.
    """
    looked_at = 0
    for i in range(len(positions)):
        radius, turned = 0.5 * sizes[i], False
        matrix = rotation(1.0, 0.0, 0.0, 0.0)
        for wall in range(6):
            axis, sign = wall // 2, 2.0 * (wall % 2) - 1.0
            touching[i, wall] = False
            if cull and sign * positions[i, axis] + radius < half[axis]:
                continue
            if not turned:
                turned = True
                looked_at += 1
                matrix = rotation(quaternions[i, 0], quaternions[i, 1], quaternions[i, 2], quaternions[i, 3])
            row = matrix[0] if axis == 0 else (matrix[1] if axis == 1 else matrix[2])
            towards = scaled(row, sign)
            hull = hull_of(hulls, i)
            vertex = support(hull, towards[0], towards[1], towards[2])
            reach = dot(towards, (hull.vertices[vertex, 0], hull.vertices[vertex, 1], hull.vertices[vertex, 2]))
            touching[i, wall] = sign * positions[i, axis] + sizes[i] * reach >= half[axis]
    return looked_at
