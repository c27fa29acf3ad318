"""Bodies whose poses were recorded, and what follows them in a scene, whether it flies or was recorded."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Ints
from harness.motion.course import Course, folded_course
from harness.motion.kinematics import Trajectory, turn
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene import Scene


class RecordedTrajectory(Trajectory):
    """The recorded poses at their times; between two of them bodies move at constant velocity and spin.

    Parameters
    ----------
    scene : whose bodies they are
    poses : of the centres, from time 0 on
    """

    def __init__(self, scene: Scene, poses: RecordedPoses) -> None:
        super().__init__(scene.bodies, scene.box, folded=False, turning=True)
        self._poses = poses

    def move_to(self, time: float) -> None:
        """Put every body where it was at `time` (s), or is on the way from one pose to the next."""
        poses, frame = self._poses, self._frame(time)
        self.positions[:], self.quaternions[:] = poses.positions[frame], poses.quaternions[frame]
        since = time - float(poses.time[frame])
        if since > 0.0:
            velocities, spins = poses.motion(frame)
            self.positions += since * velocities
            turn(poses.quaternions[frame], spins, since, self.quaternions)

    def folds(self, time: float) -> Ints:
        """(n, 6): none, for there are no walls."""
        return np.zeros((len(self.positions), 6), np.int64)

    def velocities_at(self, time: float) -> Floats:
        """(n, 3) m/s at `time`, on the way to the next pose."""
        velocities, _ = self._poses.motion(self._frame(time))
        return velocities

    def spins_at(self, time: float) -> Floats:
        """(n, 3) rad/s at `time`, on the way to the next pose."""
        _, spins = self._poses.motion(self._frame(time))
        return spins

    def _frame(self, time: float) -> int:
        return max(0, int(np.searchsorted(self._poses.time, time, side="right")) - 1)


def trajectory_of(scene: Scene, *, folded: bool, turning: bool) -> Trajectory:
    """The trajectory of the bodies of a scene; parameters as of `Trajectory`, without effect on recorded poses."""
    if scene.poses is not None:
        return RecordedTrajectory(scene, scene.poses)
    return Trajectory(scene.bodies, scene.box, folded=folded, turning=turning)


def passing_course(scene: Scene, duration: float) -> Course:
    """The course of bodies that no hit turns, for so long (s): folded by the box, or from pose to pose."""
    poses = scene.poses
    if poses is None:
        return folded_course(scene.bodies, scene.box, duration)
    frames, count = len(poses), poses.bodies
    moving = [poses.motion(frame) for frame in range(frames)]
    return Course(
        np.repeat(poses.time, count),
        np.tile(np.arange(count), frames),
        poses.positions.reshape(-1, 3),
        np.concatenate([velocities for velocities, _ in moving]),
        poses.quaternions.reshape(-1, 4),
        np.concatenate([spins for _, spins in moving]),
    )
