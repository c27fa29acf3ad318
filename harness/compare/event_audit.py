"""A method that computes events, held against exact arithmetic on the motion that the others are asked about.

It has no verdict on a pose, but it says when two bodies begin to touch while they approach. At each such time the judge
must find their surfaces within the method's tolerance. Where a stepped method sees a pair begin to touch from one frame
to the next, and the judge proves both, the method must have said so in between. Frames only propose: what is counted as
wrong is proven. Not asked is what begins while the centres part, or after an earlier contact of the same approach, for
which the method claims nothing.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.compare.budget import Budget
from harness.compare.certificate import Judgement
from harness.compare.judge import judge
from harness.compare.outcome import Case, Comparison
from harness.compare.poses import Pose
from harness.compare.tally import Tally
from harness.methods.at_poses import AtPoses
from harness.methods.registry import method_of
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import EXACT_FRAMES, MethodName

# A time and the places at it are rounded: of the coordinates and of what moves in that time.
_ROUNDING = 1e-12

Pair = tuple[int, int]


def audit_events(scene: Scene, name: str, frames: int, dt: float, tolerance: float, budget: Budget) -> Comparison:
    """Hold the contacts of an event-driven method against the judge, without response.

    Parameters
    ----------
    scene : Scene
    name : of the method, such as "fcl/predictive"
    frames, dt : how many frames propose contacts, and how far apart they are, s
    tolerance : of size, at which surfaces count as touching for the method
    budget : ends it early, and keeps what was left out

    Returns
    -------
    Comparison
        Its tally counts contacts: of `verdicts` those on which both agree, those too near to the tolerance to decide,
        and those that are proven wrong.
    """
    return _EventAudit(scene, name, tolerance).check(frames, dt, budget)


class _EventAudit:
    def __init__(self, scene: Scene, name: str, tolerance: float) -> None:
        self._scene, self._name = scene, name
        self._tolerance = 0.0 if scene.shape == "sphere" else tolerance
        self._trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=scene.shape != "sphere")
        self._tally = Tally((EXACT_FRAMES, name), scene.shape)
        self._found = Comparison([self._tally])

    def check(self, frames: int, dt: float, budget: Budget) -> Comparison:
        onsets = self._onsets(MotionLaw(frames * dt, dt, "none"))
        detector = AtPoses(MethodName.read(EXACT_FRAMES, self._scene.shape))
        detector.load(self._scene)
        before: set[Pair] = set()
        earlier: set[Pair] = set()  # pairs that have touched in their present approach
        poses = [self._pose(0.0, "frame 0")]
        for frame in range(frames + 1):
            if budget.spent:
                budget.leave_out(self._name, how=f"{frames + 1 - frame} of {frames + 1} frames not held against it")
                break
            now = self._pose(frame * dt, f"frame {frame}")
            velocities = self._trajectory.velocities_at(frame * dt)
            touching = {(i, j) for i, j in detector.pairs(now.positions, now.quaternions).tolist()}
            told = onsets.get(frame, {})
            for pair, time in told.items():
                self._check_onset(pair, time, frame)
            if frame:
                for pair in sorted(touching - before - set(told) - earlier):
                    self._check_missed(pair, (poses[-1], now), velocities, frame)
            self._tally.poses += 1
            earlier = {pair for pair in earlier | touching | set(told) if _approach(pair, now, velocities)}
            before = touching
            poses = [now]
        return self._found

    def _onsets(self, law: MotionLaw) -> dict[int, dict[Pair, float]]:
        """When it says that pairs begin to touch, s, by the frame at which that can be seen first."""
        method = method_of(MethodName.read(self._name, self._scene.shape), tolerance=self._tolerance or 1e-6)
        run = method.load(self._scene, method.plan(self._scene, law)).fly(law, traced=True)
        found: dict[int, dict[Pair, float]] = {}
        if run.trace is not None:
            for time, (i, j) in zip(run.trace.times.tolist(), run.trace.bodies.tolist(), strict=True):
                if j >= 0:
                    found.setdefault(int(np.ceil(time / law.dt)), {})[min(i, j), max(i, j)] = time
        return found

    def _check_onset(self, pair: Pair, time: float, frame: int) -> None:
        """Their surfaces are within the tolerance at that time, or deeper in each other than that only at time 0."""
        pose = self._pose(time, f"{time:.9g} s")
        truth = judge(self._scene, *pair, pose.positions, pose.quaternions)
        self._tally.verdicts += 1
        band = self._band(pair, pose, time)
        if truth.gap <= band:
            self._tally.agree += 1
        elif truth.gap <= 2.0 * band:
            self._tally.undecided += 1
        else:
            self._tally.real += 1
            self._found.cases.append(self._case(pair, truth, pose, frame))

    def _check_missed(self, pair: Pair, poses: tuple[Pose, Pose], velocities: Floats, frame: int) -> None:
        """Apart at one frame and touching at the next, while the centres approach, and it has said nothing."""
        if not all(_approach(pair, pose, velocities) for pose in poses):
            return
        truths = [judge(self._scene, *pair, pose.positions, pose.quaternions) for pose in poses]
        band = self._band(pair, poses[1], 1.0)
        self._tally.verdicts += 1
        if truths[0].gap > 2.0 * band and truths[1].touching and truths[1].gap < -band:
            self._tally.real += 1
            self._found.cases.append(self._case(pair, truths[1], poses[1], frame))
        else:
            self._tally.undecided += 1

    def _case(self, pair: Pair, truth: Judgement, pose: Pose, frame: int) -> Case:
        return Case(
            (EXACT_FRAMES, self._name), self._name, pair, truth, scene=self._scene, pose=pose, query_index=frame + 1
        )

    def _band(self, pair: Pair, pose: Pose, time: float) -> float:
        """m, by which a contact may be off: the tolerance, and the rounding of places."""
        bodies, chosen = self._scene.bodies, list(pair)
        moved = float(np.abs(bodies.velocities[chosen]).max()) * time
        return self._tolerance * float(bodies.sizes[chosen].mean()) + _ROUNDING * (
            float(np.abs(pose.positions[chosen]).max()) + float(bodies.sizes[chosen].max()) + moved
        )

    def _pose(self, time: float, name: str) -> Pose:
        self._trajectory.move_to(time)
        return Pose(name, self._trajectory.positions.copy(), self._trajectory.quaternions.copy())


def _approach(pair: Pair, pose: Pose, velocities: Floats) -> bool:
    i, j = pair
    return bool((pose.positions[j] - pose.positions[i]) @ (velocities[j] - velocities[i]) < 0.0)
