"""The poses and frames that backends are compared at: of bodies that fly, which no backend's answer can change."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from harness.arrays import Floats
from harness.compare.question import COLLISION, Question
from harness.motion.kinematics import Trajectory
from harness.motion.recorded_motion import trajectory_of
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
class Frame(Pose):
    """How all bodies of a scene move from one frame to the next; `positions` and `quaternions` are those at its start.

    Parameters
    ----------
    velocities, spins : (n, 3) float arrays, m/s and rad/s, at the start
    duration : s
    number : of the frame, from 1; 0 of one that follows no other
    """

    velocities: Floats
    spins: Floats
    duration: float
    number: int = 0

    def scene_at_start(self, scene: Scene) -> Scene:
        """The scene with its bodies as the frame begins."""
        bodies = replace(
            scene.bodies,
            positions=self.positions,
            quaternions=self.quaternions,
            velocities=self.velocities,
            spins=self.spins,
        )
        return replace(scene, bodies=bodies)

    def at(self, scene: Scene, time: float) -> Pose:
        """Where the bodies of the scene are so many seconds after the start of the frame."""
        started = self.scene_at_start(scene)
        trajectory = Trajectory(started.bodies, started.box, folded=True, turning=scene.shape != "sphere")
        trajectory.move_to(time)
        return Pose(f"{self.name}, {time:.9g} s after its start", trajectory.positions, trajectory.quaternions)


@dataclass(frozen=True, eq=False)
class PoseSet:
    """A scene and the poses at which backends are asked about it.

    Parameters
    ----------
    scene : Scene
    poses : what makes the poses, in the order in which every backend is asked, from the scene with the hulls that are
        really compared: contacts are exact only of those
    hard : whether the bodies were put where verdicts are hard; else they fly, as a user's do
    question : what is asked; where that is when bodies begin to touch, each of the poses is a `Frame`
    """

    scene: Scene
    poses: Callable[[Scene], Sequence[Pose]]
    hard: bool = False
    question: Question = COLLISION


def flown(scene: Scene, frames: int, dt: float, question: Question = COLLISION) -> PoseSet:
    """Bodies that fly through each other, from the start to frame `frames`, `dt` (s) apart, or as they were recorded.

    With a response no two bodies would ever overlap at a frame.
    """
    between = _motions if question.query == "impact" else _poses
    return PoseSet(scene, lambda held: tuple(between(held, frames, dt)), question=question)


def _motions(scene: Scene, frames: int, dt: float) -> Iterator[Frame]:
    trajectory = trajectory_of(scene, folded=True, turning=False)
    for number, pose in enumerate(_poses(scene, frames - 1, dt), 1):
        start = _time(scene, number - 1, dt)
        motion = trajectory.velocities_at(start), trajectory.spins_at(start)
        duration = dt if scene.poses is None else _time(scene, number, dt) - start
        yield Frame(f"frame {number}", pose.positions, pose.quaternions, *motion, duration, number)


def _poses(scene: Scene, frames: int, dt: float) -> Iterator[Pose]:
    trajectory = trajectory_of(scene, folded=True, turning=scene.shape != "sphere")
    for frame in range(frames + 1):
        trajectory.move_to(_time(scene, frame, dt))
        yield Pose(f"frame {frame}", trajectory.positions.copy(), trajectory.quaternions.copy())


def _time(scene: Scene, frame: int, dt: float) -> float:
    """s"""
    return frame * dt if scene.poses is None else float(scene.poses.time[frame])
