"""Where the bodies of a hit touch: for a replay, from their nearest points at that time, or just before it."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.methods.near_pairs import gap_search
from harness.motion.hits import Trace
from harness.motion.kinematics import Trajectory
from harness.motion.recorded_motion import trajectory_of
from harness.narrowphase.gap import EXACT
from harness.scene.scene import Scene

# s before a hit at which nearest points are looked for until there are some: of bodies that touch there are none.
_BACK = (0.0, 1e-9, 1e-7, 1e-5, 1e-3)


def contact_points(scene: Scene, trace: Trace) -> Floats:
    """(k, 3) m, the point at which the bodies of each hit touch; nan at walls.

    Parameters
    ----------
    scene : at time 0, without response
    trace : of a flight of it
    """
    found = np.full((len(trace.times), 3), np.nan)
    between = np.flatnonzero(trace.walls < 0)
    if not len(between):
        return found
    search = gap_search(scene)
    trajectory = trajectory_of(scene, folded=True, turning=scene.shape != "sphere")
    for hit in between.tolist():
        pair = trace.bodies[hit : hit + 1]
        for back in _BACK:
            trajectory.move_to(max(0.0, float(trace.times[hit]) - back))
            gaps, points = search(pair, trajectory.positions, trajectory.quaternions, EXACT)
            if gaps[0] > 0.0:
                found[hit] = points[0].mean(axis=0)
                break
        else:
            found[hit] = _between(scene, trajectory, *pair[0].tolist())
    return found


def _between(scene: Scene, trajectory: Trajectory, i: int, j: int) -> Floats:
    """m, where spheres around two bodies would touch."""
    radii, (a, b) = scene.bodies.radii, trajectory.positions[[i, j]]
    point: Floats = a + radii[i] / (radii[i] + radii[j]) * (b - a)
    return point
