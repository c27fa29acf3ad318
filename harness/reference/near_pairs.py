"""Which pairs are near in frames of a motion, with bounds on their gaps that no search of the narrow phase has given.

A run's frames are sampled, since every pair is bounded by itself: as many frames as it takes for the number of pairs
that follows, spread over the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.motion.recorded_motion import trajectory_of
from harness.reference.body_gaps import GapBounds, sphere_bounds, surface_bounds
from harness.scene.ignored_pairs import without
from harness.scene.mesh import Surface
from harness.scene.scene import Scene

# Pairs whose bounding spheres are near, of all sampled frames together, and frames, at the most.
MOST_PAIRS, MOST_FRAMES = 300, 16
# Relative: by how much more than a gap pairs are taken, so that rounding loses none.
_SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class NearReference:
    """The pairs whose gap may be at most a distance, in some frames of a motion.

    Parameters
    ----------
    frames : (f,) int array, ascending, those that were looked at
    at : (k,) int array, the frame of each pair, ascending
    pairs : (k, 2) int array
    lower, upper : (k,) float arrays, m, bounds on the gap; 0 where the two touch
    """

    frames: Ints
    at: Ints
    pairs: Pairs
    lower: Floats
    upper: Floats


class _Near(NamedTuple):
    """A pair of a frame that may be near, and the bounds on its gap, m."""

    frame: int
    i: int
    j: int
    lower: float
    upper: float


def near_reference(scene: Scene, law: MotionLaw, within: float) -> NearReference:
    """The near pairs of sampled frames.

    Parameters
    ----------
    scene : of the shape that is asked about
    law : without response
    within : m
    """
    trajectory = trajectory_of(scene, folded=True, turning=True)
    frames: list[int] = []
    found: list[_Near] = []
    count = 0
    for frame in _spread(law.frames):
        trajectory.move_to(law.time_of(frame))
        close = _close(scene, trajectory.positions, within)
        if frames and count + len(close) > MOST_PAIRS:
            break
        count += len(close)
        frames.append(frame)
        for i, j in close.tolist():
            bounds = pair_bounds(scene, trajectory, i, j)
            if bounds.lower <= within:
                found.append(_Near(frame, i, j, *bounds))
    found.sort()
    return NearReference(
        frames=np.array(sorted(frames), np.int64),
        at=np.array([near.frame for near in found], np.int64),
        pairs=np.array([(near.i, near.j) for near in found], np.int64).reshape(-1, 2),
        lower=np.array([near.lower for near in found], np.float64),
        upper=np.array([near.upper for near in found], np.float64),
    )


def pair_bounds(scene: Scene, trajectory: Trajectory, i: int, j: int) -> GapBounds:
    """Bounds on the gap of two bodies where they are."""
    offset = trajectory.positions[j] - trajectory.positions[i]
    if scene.shape == "sphere":
        radii = scene.bodies.radii
        return sphere_bounds(offset, float(radii[i]), float(radii[j]))
    one, other = placed(scene, trajectory, i), placed(scene, trajectory, j)
    return surface_bounds(one, Surface(other.vertices + offset, other.faces), solid=scene.shape == "hull")


def placed(scene: Scene, trajectory: Trajectory, body: int) -> Surface:
    """A body's surface as it is turned, in m from its centre."""
    solid = scene.solid_of_body(body)
    return Surface(solid.vertices @ _matrix(trajectory.quaternions[body]).T, solid.faces)


def _matrix(quaternion: Floats) -> Floats:
    w, x, y, z = quaternion.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _spread(frames: int) -> list[int]:
    """Frames to look at, the first few of which are spread over the run already: halves, then quarters, …"""
    chosen: list[int] = []
    parts = 1
    while len(chosen) < min(MOST_FRAMES, frames):
        for part in range(1, parts + 1, 2) if parts > 1 else (1,):
            frame = max(1, round(frames * part / parts))
            if frame not in chosen and len(chosen) < MOST_FRAMES:
                chosen.append(frame)
        parts *= 2
    return chosen


def _close(scene: Scene, positions: Floats, within: float) -> Pairs:
    """(k, 2): pairs whose bounding spheres are that near."""
    radii = scene.enclosing_radii
    if len(radii) < 2:
        return np.empty((0, 2), np.int64)
    from scipy.spatial import cKDTree  # which a plan need not wait for

    widest = (2.0 * float(radii.max()) + within) * (1.0 + _SLACK)
    pairs = cKDTree(positions).query_pairs(widest, output_type="ndarray").astype(np.int64).reshape(-1, 2)
    pairs.sort(axis=1)
    distances = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
    near = distances <= (radii[pairs[:, 0]] + radii[pairs[:, 1]] + within) * (1.0 + _SLACK)
    found: Pairs = pairs[near][np.lexsort((pairs[near][:, 1], pairs[near][:, 0]))]
    return without(found, scene.ignored)
