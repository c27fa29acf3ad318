"""Records the motion of `experiments/recorded/`: a bin that pybullet fills, and an arm that sweeps through obstacles.

Also the stacks of `experiments/atlas/resting.yaml`.

    python -m tests.scene.record_scenes FOLDER

writes bin.npz, bin-at-rest.npz, bin.off, arm.npz, cubes.npz and balls.npz, and the bodies of the bin and of the arm
as the YAML files list them.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pybullet
import pybullet_data

from harness.scene.mesh_file import read_mesh

DATA = Path(pybullet_data.getDataPath())
SEED = 259

# The bin: an open box with walls that lean outwards.
FLOOR, RIM, HEIGHT, WALL = 1.1, 1.8, 1.1, 0.1
BODIES = 60
STEP, STEPS_A_FRAME, FRAMES = 1 / 480, 20, 200
FRICTION = {"rollingFriction": 0.02, "spinningFriction": 0.02, "linearDamping": 0.2, "angularDamping": 0.3}
# Frames at the end, in which all bodies rest.
REST = 12
# m. pybullet takes the origin of a file for the centre of mass: these have it in their middle.
SIZES = {
    "bunny.obj": 0.34,
    "cube.obj": 0.32,
    "domino/domino.obj": 0.34,
    "jenga/jenga.obj": 0.4,
    "random_urdfs/000/000.obj": 0.34,
    "random_urdfs/005/005.obj": 0.38,
    "sphere_smooth.obj": 0.26,
    "stone.obj": 0.34,
}

ARM = "kuka_iiwa/model.urdf"
LINKS = [f"kuka_iiwa/meshes/link_{number}.stl" for number in range(8)]
OBSTACLES = [
    ("soccerball.obj", 0.35, (0.45, 0.25, 0.75)),
    ("duck.obj", 0.4, (0.05, 0.55, 0.55)),
    ("cube.obj", 0.4, (-0.5, 0.2, 0.6)),
    ("teddy2_VHACD_CHs.obj", 0.4, (-0.3, -0.5, 0.7)),
    ("random_urdfs/000/000.obj", 0.3, (0.4, -0.4, 0.9)),
]
ARM_FRAMES, ARM_SECONDS = 240, 8.0

MESHES = Path(__file__).parents[2] / "meshes"
STACKED, STACK_FRAMES = 24, 4

STILL = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def bin_mesh():
    """(16, 3) vertices and (28, 3) faces of the bin, closed."""
    square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    rings = [(FLOOR / 2 + WALL, -WALL), (RIM / 2 + WALL, HEIGHT), (RIM / 2, HEIGHT), (FLOOR / 2, 0.0)]
    vertices = np.concatenate([np.column_stack([half * square, np.full(4, z)]) for half, z in rings])
    faces = [[0, 2, 1], [0, 3, 2], [12, 13, 14], [12, 14, 15]]
    for ring in range(3):
        for side in range(4):
            a, b = 4 * ring + side, 4 * ring + (side + 1) % 4
            faces += [[a, b, b + 4], [a, b + 4, a + 4]]
    return vertices, np.array(faces)


def write_off(path, vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0", *(" ".join(f"{x:.17g}" for x in row) for row in vertices)]
    path.write_text("\n".join([*lines, *(f"3 {a} {b} {c}" for a, b, c in faces)]) + "\n")


def scale_of(name):
    """What makes a mesh as large as its body."""
    return SIZES[name] / read_mesh(DATA / name).diameter


def fill_bin():
    """Drop bodies into the bin until they rest; the poses of all frames."""
    rng, names = np.random.default_rng(SEED), list(SIZES)
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP, numSolverIterations=100)
    corners = bin_mesh()[0].reshape(4, 4, 3)
    floor = corners[[0, 3]].reshape(-1, 3)
    walls = [corners[:, [side, (side + 1) % 4]].reshape(-1, 3) for side in range(4)]
    for slab in (floor, *walls):  # convex: thin bodies are pressed through a surface of triangles
        shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=slab.tolist())
        pybullet.createMultiBody(0, shape)
    for axis in range(2):  # a chute above the rim: nothing bounces out of the bin
        for side in (-1.0, 1.0):
            half, at = [RIM, RIM, 2.0], [0.0, 0.0, HEIGHT + 2.0]
            half[axis], at[axis] = 0.2, side * (RIM / 2 + 0.2)
            pybullet.createMultiBody(
                0, pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half), basePosition=at
            )
    bodies = []
    shapes = {
        name: pybullet.createCollisionShape(
            pybullet.GEOM_MESH, fileName=str(DATA / name), meshScale=[scale_of(name)] * 3
        )
        for name in names
    }
    for number in range(BODIES):
        layer, place = divmod(number, 9)
        x, y = 0.38 * (place % 3 - 1), 0.38 * (place // 3 - 1)
        turn = rng.normal(size=4)
        at = [x + rng.uniform(-0.01, 0.01), y + rng.uniform(-0.01, 0.01), 0.4 + 0.45 * layer]
        shape = shapes[names[number % len(names)]]
        turn /= np.linalg.norm(turn)
        bodies.append(pybullet.createMultiBody(0.2, shape, basePosition=at, baseOrientation=turn))
        pybullet.changeDynamics(bodies[-1], -1, **FRICTION)
    poses = []
    for _ in range(FRAMES):
        poses.append([STILL, *(pybullet.getBasePositionAndOrientation(body) for body in bodies)])
        for _ in range(STEPS_A_FRAME):
            pybullet.stepSimulation()
    pybullet.disconnect()
    return np.arange(FRAMES) * STEP * STEPS_A_FRAME, poses


def sweep_arm():
    """Joints of the arm on sines of different rates, through obstacles that stand still; the poses of all frames."""
    pybullet.connect(pybullet.DIRECT)
    arm = pybullet.loadURDF(str(DATA / ARM), useFixedBase=True)
    time = np.linspace(0.0, ARM_SECONDS, ARM_FRAMES + 1)
    still = [(at, (0.0, 0.0, 0.0, 1.0)) for _, _, at in OBSTACLES]
    poses = []
    for now in time:
        for joint in range(pybullet.getNumJoints(arm)):
            pybullet.resetJointState(arm, joint, 1.4 * np.sin((0.5 + 0.13 * joint) * now + joint))
        links = [pybullet.getLinkState(arm, joint, computeForwardKinematics=True)[4:6] for joint in range(7)]
        base = pybullet.multiplyTransforms(
            *pybullet.getBasePositionAndOrientation(arm),
            *pybullet.invertTransform(*pybullet.getDynamicsInfo(arm, -1)[3:5]),
        )
        poses.append([base, *links, *still])
    pybullet.disconnect()
    return time, poses


def stack(mesh):
    """Bodies of a mesh, 1 m across, dropped onto each other in a pit until they rest; the poses of the last frames.

    Cubes fall in towers, each turned a little and not quite straight; round bodies find their own places.
    """
    rng = np.random.default_rng(SEED)
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP, numSolverIterations=100)
    width = 2.4
    for at, half in (
        ((0, 0, -0.5), (5, 5, 0.5)),
        *(((side * (width / 2 + 0.5), 0, 5), (0.5, 5, 5)) for side in (-1, 1)),
        *(((0, side * (width / 2 + 0.5), 5), (5, 0.5, 5)) for side in (-1, 1)),
    ):
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half)
        pybullet.createMultiBody(0, box, basePosition=at)
    read = read_mesh(MESHES / mesh)
    shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=(read.vertices / read.diameter).tolist())
    bodies = []
    for number in range(STACKED):
        layer, place = divmod(number, 4)
        x, y = 1.2 * (place % 2) - 0.6, 1.2 * (place // 2) - 0.6
        yaw = rng.uniform(-0.1, 0.1) + 0.3 * place
        at = [x + rng.uniform(-0.05, 0.05), y + rng.uniform(-0.05, 0.05), 0.35 + 0.6 * layer]
        turn = pybullet.getQuaternionFromEuler([0, 0, yaw])
        bodies.append(pybullet.createMultiBody(0.2, shape, basePosition=at, baseOrientation=turn))
        pybullet.changeDynamics(bodies[-1], -1, lateralFriction=0.8, **FRICTION)
    poses = []
    for _ in range(FRAMES + STACK_FRAMES):
        poses.append([pybullet.getBasePositionAndOrientation(body) for body in bodies])
        for _ in range(STEPS_A_FRAME):
            pybullet.stepSimulation()
    pybullet.disconnect()
    return np.arange(STACK_FRAMES) * STEP * STEPS_A_FRAME, poses[-STACK_FRAMES:]


def save(path, time, poses):
    """An .npz as experiments read it; a quaternion of pybullet is x y z w."""
    positions = np.array([[at for at, _ in frame] for frame in poses], np.float32)
    turns = np.array([[turn for _, turn in frame] for frame in poses])[:, :, [3, 0, 1, 2]].astype(np.float32)
    np.savez_compressed(path, time=time, positions=positions, quaternions=turns)


def package(name):
    return f"package:pybullet_data/{name}"


def main(folder):
    write_off(folder / "bin.off", *bin_mesh())
    time, poses = fill_bin()
    save(folder / "bin.npz", time, poses)
    save(folder / "bin-at-rest.npz", time[-REST:], poses[-REST:])
    save(folder / "arm.npz", *sweep_arm())
    save(folder / "cubes.npz", *stack("cube.ply"))
    save(folder / "balls.npz", *stack("icosphere-1280.ply"))
    names = [list(SIZES)[number % len(SIZES)] for number in range(BODIES)]
    of_bin = [("bin.off", "native"), *((package(name), SIZES[name]) for name in names)]
    of_arm = [(package(name), "native") for name in LINKS] + [(package(name), size) for name, size, _ in OBSTACLES]
    for file, bodies in (("bin-bodies.txt", of_bin), ("arm-bodies.txt", of_arm)):
        rows = [f"    - {{mesh: {json.dumps(name)}, size: {size}}}\n" for name, size in bodies]
        (folder / file).write_text("".join(rows))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
