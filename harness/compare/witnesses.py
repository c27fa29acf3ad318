"""The nearest points that a library gives with a gap: whether they lie on the bodies, as far apart as it says.

A gap that is right, with two points of the bodies that are as far apart, makes them nearest points. Points are held to
a hundredth of a size, whatever a library declares of gaps. Seven libraries were asked at some 3000 poses: all but one
keep to 3e-7, and pybullet, whose hulls have a margin, to 2e-3 but for three poses where a point is half a size off.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.arrays import Floats
from harness.backends.protocol import NearPairs
from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, surface_distance
from harness.compare.poses import Pose
from harness.scene.scene import Scene
from harness.vocabulary import Shape

# Of a size.
_ALLOWED = 0.01
# Pairs of a pose whose points are looked at, which takes some 1, 5 and 30 ms each.
_MOST: Mapping[Shape, int] = {"sphere": 8, "hull": 4, "mesh": 1}


def misplaced(scene: Scene, pose: Pose, found: NearPairs) -> tuple[tuple[int, int], float] | None:
    """The first pair of those looked at whose nearest points are off, and by how much, m; None if there is none.

    Parameters
    ----------
    scene : of the shape that the library holds
    pose : Pose
    found : what it says there; points of pairs that touch mean nothing
    """
    if found.points is None:
        return None
    apart = np.flatnonzero(found.gaps > 0.0)
    for row in apart[:: max(1, -(-len(apart) // _MOST[scene.shape]))].tolist():
        i, j = found.pairs[row].tolist()
        off = _off_by(scene, pose, (i, j), float(found.gaps[row]), found.points[row])
        if off > _ALLOWED * float(scene.bodies.sizes[[i, j]].max()):
            return (i, j), off
    return None


def _off_by(scene: Scene, pose: Pose, pair: tuple[int, int], gap: float, points: Floats) -> float:
    """m, exact but for its rounding."""
    off = abs(float(np.linalg.norm(points[0] - points[1])) - gap)
    for body, point in zip(pair, points, strict=True):
        off = max(off, _outside(scene, pose, body, point))
    return off


def _outside(scene: Scene, pose: Pose, body: int, point: Floats) -> float:
    """m, how far a point is from a body: from a mesh's surface, or outside of what is solid."""
    if scene.shape == "sphere":
        return float(np.linalg.norm(point - pose.positions[body])) - float(scene.bodies.radii[body])
    solid = scene.solid_of_body(body)
    placed = PlacedPoints(solid.vertices, pose.positions[body], pose.quaternions[body])
    alone = PlacedPoints(np.zeros((1, 3)), point, np.array([1.0, 0.0, 0.0, 0.0]))
    if scene.shape == "hull":
        return hull_distance(placed, alone).gap
    return surface_distance(placed, solid.faces, alone, np.zeros((1, 3), np.int32)).gap
