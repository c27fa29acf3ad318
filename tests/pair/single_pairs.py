"""Prints what the time of impact of a single pair costs, by this program and by rapier3d, as a table of Markdown.

    python -m tests.pair.single_pairs

A body flies at 1 m/s at another from 2 m away, aimed at its middle to about .15 m; one spins, the other is at rest, as
rapier3d's cast has it. Bodies have a bounding radius of .5 m. Both are asked about the same motions, up to 3 s.
"""

import time
import warnings
from statistics import median

import numpy as np

import harness
from harness.backends.poses import UniformMotion
from harness.backends.rapier_casts import Casts, ShapeData
from harness.cpu_time import cpu_time

TOLERANCE, DURATION = 1e-10, 3.0
# shape, mesh, spins in rad/s, pairs that this program is asked about, and rapier3d
CASES = (
    ("hull", "pumpkin-1753.ply", (0.5, 5.0, 50.0), 300, 100),
    ("mesh", "pumpkin-1753.ply", (0.5, 5.0), 100, 6),
    ("mesh", "pumpkin-17001.ply", (5.0,), 60, 0),
)


def motions(count, spin):
    """Bodies 2 k at rest, bodies 2 k + 1 in motion: (2 count, 3 or 4) each."""
    rng = np.random.default_rng(1)

    def directions():
        found = rng.normal(size=(count, 3))
        return found / np.linalg.norm(found, axis=1)[:, None]

    positions, velocities, spins = (np.zeros((2 * count, 3)) for _ in range(3))
    quaternions = np.tile([1.0, 0.0, 0.0, 0.0], (2 * count, 1))
    positions[1::2] = 2.0 * directions()
    aims = 0.15 * rng.normal(size=(count, 3)) - positions[1::2]
    velocities[1::2] = aims / np.linalg.norm(aims, axis=1)[:, None]
    spins[1::2] = spin * directions()
    turned = rng.normal(size=(count, 4))
    quaternions[1::2] = turned / np.linalg.norm(turned, axis=1)[:, None]
    return UniformMotion(positions, quaternions, velocities, spins, DURATION)


def own(mesh, shape, motion):
    """The times, s, and the CPU time of one, s: the median of five calls about all of them."""
    sides = [
        harness.Body(
            mesh,
            position=motion.positions[side::2],
            quaternion=motion.quaternions[side::2],
            velocity=motion.velocities[side::2],
            spin=motion.spins[side::2],
            shape=shape,
        )
        for side in (0, 1)
    ]
    took = []
    for _ in range(6):  # the first compiles
        begin = time.process_time()
        times = harness.time_of_impact(*sides, DURATION, tolerance=TOLERANCE)
        took.append((time.process_time() - begin) / len(times))
    return times, median(took[1:])


def rapier(mesh, shape, motion):
    """The times, s, infinite where it says that none meet or nothing at all; and the CPU time of one, s."""
    surface = harness.Body(mesh).mesh
    solid = surface.hull if shape == "hull" else surface
    data = ShapeData(0.5, solid.vertices.tolist(), [] if shape == "hull" else solid.faces.tolist())
    pairs = np.arange(len(motion.positions)).reshape(-1, 2)
    casts = Casts({0: data}, [0] * len(motion.positions), 1.0)
    begin = cpu_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = casts.impacts(pairs, motion)
    took = (cpu_time() - begin) / len(pairs)
    times = np.full(len(pairs), np.inf)
    for i, _, when in found:
        times[i // 2] = when
    return times, took, casts.unanswered


def main():
    print("| bodies | spin, rad/s | own, µs a pair | rapier3d, µs a pair | ratio | rapier3d late or without a hit |")
    print("|---|---|---|---|---|---|")
    for shape, mesh, spins, count, asked in CASES:
        surface = harness.Body(mesh).mesh
        kind = f"mesh of {len(surface.faces)} faces"
        if shape == "hull":
            kind = f"hull of {len(surface.hull.vertices)} vertices"
        for spin in spins:
            times, took = own(mesh, shape, motions(count, spin))
            cells = ["", "", ""]
            if asked:
                motion = motions(count, spin)
                first = UniformMotion(*(array[: 2 * asked] for array in motion[:4]), DURATION)
                theirs, dear, silent = rapier(mesh, shape, first)
                late = int((theirs > times[:asked] + 1e-3).sum())
                cells = [f"{dear * 1e6:.4g}", f"{dear / took:.3g}", f"{late} of {asked}"]
                cells[2] += f", {silent} unanswered" if silent else ""
            print(f"| {kind} | {spin:g} | {took * 1e6:.3g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
