"""Which walls of the box a body touches: its lowest and highest point along each axis against the planes.

The lowest and highest points are the support function of the convex hull (of the sphere) along the wall normals; a mesh
reaches exactly as far as its hull. A body that touches a plane or is beyond it touches the wall.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Flags, Floats
from harness.kernel import kernel


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
    vertices: Floats,
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
        Diameters of the bounding spheres; the hull itself has diameter 1.
    vertices : (h, 3) float array
        Vertices of the hull, centred on its bounding sphere.
    half : (3,) float array, m
    cull : bool
        Skip the hull of a body whose bounding sphere reaches no wall. The answer is the same.
    touching : (n, 6) bool array
        Overwritten, in the order x-, x+, y-, y+, z-, z+.

    Returns
    -------
    int
        Bodies whose hull was looked at.
    """
    looked_at = 0
    for i in range(len(positions)):
        touching[i] = False
        if cull:
            radius = 0.5 * sizes[i]
            within = True
            for axis in range(3):
                within = within and abs(positions[i, axis]) + radius < half[axis]
            if within:
                continue
        looked_at += 1
        w, x, y, z = quaternions[i]
        rotation = (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
        for axis in range(3):
            a, b, c = rotation[axis]
            low = np.inf
            high = -np.inf
            for k in range(len(vertices)):
                reach = a * vertices[k, 0] + b * vertices[k, 1] + c * vertices[k, 2]
                low = min(low, reach)
                high = max(high, reach)
            touching[i, 2 * axis] = positions[i, axis] + sizes[i] * low <= -half[axis]
            touching[i, 2 * axis + 1] = positions[i, axis] + sizes[i] * high >= half[axis]
    return looked_at
