"""The nearest points that a library gives with a gap: whether they lie on the bodies, as far apart as it says.

A gap that is right, with two points of the bodies that are as far apart, makes them nearest points. Points are held to
a hundredth of a size, whatever a library declares of gaps. Seven libraries were asked at some 3000 poses: all but one
keep to 3e-7, and pybullet, whose hulls have a margin, to 2e-3 but for three poses where a point is half a size off.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.backends.protocol import NearPairs
from harness.compare.poses import Pose
from harness.reference.body_gaps import off_surface
from harness.reference.near_pairs import placed
from harness.scene.scene import Scene

# Of a size.
_ALLOWED = 0.01
# Pairs of a pose whose points are looked at: of a mesh each takes as long as all of its faces.
_MOST = 8


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
    for row in apart[:: max(1, -(-len(apart) // _MOST))].tolist():
        i, j = found.pairs[row].tolist()
        off = _off_by(scene, pose, (i, j), float(found.gaps[row]), found.points[row])
        if off > _ALLOWED * float(scene.bodies.sizes[[i, j]].max()):
            return (i, j), off
    return None


def _off_by(scene: Scene, pose: Pose, pair: tuple[int, int], gap: float, points: Floats) -> float:
    off = abs(float(np.linalg.norm(points[0] - points[1])) - gap)
    for body, point in zip(pair, points, strict=True):
        arm = (point - pose.positions[body])[None]
        if scene.shape == "sphere":
            outside = float(np.linalg.norm(arm)) - float(scene.bodies.radii[body])
        else:
            outside = float(off_surface(arm, placed(scene, pose.quaternions, body), solid=scene.shape == "hull")[0])
        off = max(off, outside)
    return off
