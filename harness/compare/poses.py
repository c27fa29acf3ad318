"""The poses that backends are compared at: those that bodies fly through, which no backend's answer can change."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from harness.arrays import Floats
from harness.motion.kinematics import Trajectory
from harness.scene.scene import Scene


@dataclass(frozen=True, eq=False)
class Pose:
    """Where all bodies of a scene are at one moment.

    Parameters
    ----------
    name : what a person calls it, such as "frame 12"
    positions : (n, 3) float array, m
    quaternions : (n, 4) float array, w x y z
    """

    name: str
    positions: Floats
    quaternions: Floats


@dataclass(frozen=True, eq=False)
class PoseSet:
    """A scene and the poses at which backends are asked about it.

    Parameters
    ----------
    scene : Scene
    poses : what makes the poses, in the order in which every backend is asked, from the scene with the hulls that are
        really compared: contacts are exact only of those
    hard : whether the bodies were put where verdicts are hard; else they fly, as a user's do
    """

    scene: Scene
    poses: Callable[[Scene], Sequence[Pose]]
    hard: bool = False


def flown(scene: Scene, frames: int, dt: float) -> PoseSet:
    """Bodies that fly through each other, from the start to frame `frames`, `dt` (s) apart.

    With a response no two bodies would ever overlap at a frame.
    """
    return PoseSet(scene, lambda held: tuple(_frames(held, frames, dt)))


def _frames(scene: Scene, frames: int, dt: float) -> Iterator[Pose]:
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=scene.shape != "sphere")
    for frame in range(frames + 1):
        trajectory.move_to(frame * dt)
        yield Pose(f"frame {frame}", trajectory.positions.copy(), trajectory.quaternions.copy())
