"""Scenes of three to eight meshes, drawn and recorded: the methods of the engine agree, and so does the exact judge.

    python -m tests.methods.many_mixtures [SCENES]

Every other scene is recorded: its bodies go from one random pose to the next. Each is asked of brute force on FCL,
`grid`, `sap` and `tree`, frame by frame, hulls and surfaces in turn; the judge decides the touching pair and the other
of unlike meshes that have the fewest faces. Prints how many scenes, frames and verdicts there were; how many differ.
"""

import sys

import numpy as np

from harness.compare.judge import touches
from harness.methods.registry import method_of
from harness.methods.stepping import Stepping
from harness.motion.law import MotionLaw
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import cube_mesh
from tests.narrowphase.meshes import mesh_named

NAMES = (
    "pumpkin-1753.ply",
    "icosphere-1280.ply",
    "package:pybullet_data/duck.obj",
    "package:pybullet_data/teddy2_VHACD_CHs.obj",
    "package:pybullet_data/bunny.obj",
    "package:pybullet_data/stone.obj",
    "package:pybullet_data/soccerball.obj",
)
METHODS = ("fcl/grid", "fcl/sap", "fcl/tree")
FRAMES, BODIES = 6, 16


def scene_of(number, meshes):
    """The scene, and the law of its motion."""
    rng = np.random.default_rng(number)
    chosen = tuple(meshes[k] for k in rng.permutation(len(meshes))[: rng.integers(3, len(meshes) + 1)])
    sizes = rng.uniform(0.4, 1.4, BODIES) if number % 3 else np.ones(BODIES)
    mesh_of = rng.integers(len(chosen), size=BODIES)
    shape = "hull" if number % 4 < 2 else "mesh"
    if number % 2:
        time = np.cumsum(rng.uniform(0.02, 0.1, FRAMES + 1))
        positions = rng.uniform(-0.9, 0.9, (FRAMES + 1, BODIES, 3))
        quaternions = np.array([orientations(rng, BODIES) for _ in time])
        recorded = RecordedPoses("drawn", time - time[0], positions, quaternions, f"drawn {number}")
        bodies = recorded.at_start(sizes, sizes**3)
        times = tuple(recorded.time.tolist())
        law = MotionLaw(times[-1], times[-1] / FRAMES, "none", times=times)
        return Scene(shape, chosen, bodies, Box(np.full(3, 2.0)), mesh_of=mesh_of, poses=recorded), law
    positions, spins = rng.uniform(-0.9, 0.9, (BODIES, 3)), directions(rng, BODIES) * rng.uniform(0, 3, (BODIES, 1))
    bodies = Bodies(positions, directions(rng, BODIES), orientations(rng, BODIES), spins, sizes, sizes**3)
    law = MotionLaw(0.05 * FRAMES, 0.05, "none")
    return Scene(shape, chosen, bodies, Box(np.full(3, 1.8)), mesh_of=mesh_of), law


class Watched:
    """A detector, and what it was asked and answered."""

    def __init__(self, detector):
        self.detector, self.asked = detector, []

    def __getattr__(self, name):
        return getattr(self.detector, name)

    def pairs(self, positions, quaternions):
        found = self.detector.pairs(positions, quaternions)
        self.asked.append((positions.copy(), quaternions.copy(), found.tolist()))
        return found


def frames_of(name, scene, law):
    """The poses of every frame, and the pairs that a method finds."""
    method = method_of(MethodName.read(name, scene.shape))
    plan = method.plan(scene, law)
    watched = Watched(method.detector(scene, plan))
    Stepping(scene, plan, watched).fly(law)
    return watched.asked


def main(scenes):
    meshes = [cube_mesh(), *map(mesh_named, NAMES)]
    frames = pairs = differ = judged = wrong = 0
    for number in range(scenes):
        scene, law = scene_of(number, meshes)
        expected = frames_of("fcl", scene, law)
        frames += len(expected)
        pairs += sum(len(found) for _, _, found in expected)
        for name in METHODS:
            asked = frames_of(name, scene, law)
            same = [np.array_equal(a[0], b[0]) and a[2] == b[2] for a, b in zip(asked, expected, strict=True)]
            if not all(same):
                differ += 1
                print(
                    f"scene {number}: {name} differs from brute force in frames {np.flatnonzero(~np.array(same)) + 1}"
                )
        faces = np.array([len(mesh.faces) for mesh in scene.meshes])[scene.mesh_of]
        every = [(i, j) for i in range(BODIES) for j in range(i + 1, BODIES) if scene.mesh_of[i] != scene.mesh_of[j]]
        every.sort(key=lambda pair: faces[list(pair)].sum())
        positions, quaternions, found = expected[-1]
        for touching in (True, False):
            i, j = next(pair for pair in every if (list(pair) in found) == touching)
            judged += 1
            if touches(scene, i, j, positions, quaternions) != touching:
                wrong += 1
                print(f"scene {number}: bodies {i} and {j}: the judge contradicts brute force")
        print(f"{number + 1} scenes, {frames} frames, {pairs} touching pairs", flush=True)
    print(
        f"{scenes} scenes: {differ} methods differ from brute force; {judged} verdicts of the judge, {wrong} against it"
    )
    return differ + wrong


if __name__ == "__main__":
    sys.exit(bool(main(int(sys.argv[1]) if len(sys.argv) > 1 else 50)))
