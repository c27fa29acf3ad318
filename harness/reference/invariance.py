"""Whether a motion is invariant, as the laws are: under reversal of time, numbering, mirroring, and units.

Each check runs the scene once more, changed in a way that leaves the laws of motion as they are, and measures how far
the bodies end from where they should. A check costs a run, so that only those are made whose metrics are asked for. The
changes are exact in floating point (signs, an order, powers of two): what is measured is the method's own error.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.motion.hits import Trace
from harness.motion.kinematics import Trajectory
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import hull_of
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

Fly = Callable[[Scene, float], Trace]
"""Flies a scene by the method that is checked, with its duration and its frames this many times as long."""

# Factors of length and time: powers of two change no digit of a coordinate, so that only absolute thresholds show.
LONGER, SLOWER = 1024.0, 4096.0


def invariance(names: Collection[str], scene: Scene, fly: Fly) -> dict[str, float]:
    """Those of the metrics of this module that are named.

    Parameters
    ----------
    names : of metrics; others are passed over
    scene : as the run started
    fly : the run's own method
    """
    asked = [name for name in CHECKS if name in names]
    if not asked:
        return {}
    end = fly(scene, 1.0)
    return {name: CHECKS[name](scene, end, fly) for name in asked}


def reversal_error(scene: Scene, end: Trace, fly: Fly) -> float:
    """Largest distance of a body from its start, of the mean size, after it was flown there and back."""
    backward = Bodies(
        positions=end.positions,
        velocities=-end.velocities,
        quaternions=_turned(scene, end.time),
        spins=-scene.bodies.spins,
        sizes=scene.bodies.sizes,
        masses=scene.bodies.masses,
    )
    return _apart(fly(replace(scene, bodies=backward), 1.0).positions, scene.bodies.positions, scene)


def relabelling_error(scene: Scene, end: Trace, fly: Fly) -> float:
    """Largest distance between where a body ends and where it ends with all bodies numbered backwards."""
    order = np.arange(len(scene.bodies))[::-1]
    other = fly(
        replace(scene, bodies=_ordered(scene.bodies, order), mesh_of=scene.mesh_of[order], ignored=_renumbered(scene)),
        1.0,
    )
    return _apart(other.positions[order], end.positions, scene)


def mirror_error(scene: Scene, end: Trace, fly: Fly) -> float:
    """Largest distance between where a body ends and the mirror image of where its mirror image ends."""
    flip = np.array([-1.0, 1.0, 1.0])
    bodies = scene.bodies
    mirrored = Bodies(
        positions=bodies.positions * flip,
        velocities=bodies.velocities * flip,
        # a rotation about an axis in the mirror turns the other way round, one about the normal stays
        quaternions=bodies.quaternions * np.array([1.0, 1.0, -1.0, -1.0]),
        spins=bodies.spins * -flip,
        sizes=bodies.sizes,
        masses=bodies.masses,
    )
    meshes = tuple(_mirrored(mesh, flip) for mesh in scene.meshes) if scene.shape != "sphere" else scene.meshes
    other = fly(replace(scene, meshes=meshes, bodies=mirrored), 1.0)
    return _apart(other.positions * flip, end.positions, scene)


def scaling_error(scene: Scene, end: Trace, fly: Fly) -> float:
    """Largest distance between where a body ends and where it ends with all lengths and times in other units."""
    bodies = scene.bodies
    scaled = Bodies(
        positions=bodies.positions * LONGER,
        velocities=bodies.velocities * (LONGER / SLOWER),
        quaternions=bodies.quaternions,
        spins=bodies.spins / SLOWER,
        sizes=bodies.sizes * LONGER,
        masses=bodies.masses,
    )
    other = fly(replace(scene, bodies=scaled, box=Box(scene.box.half * LONGER)), SLOWER)
    return _apart(other.positions / LONGER, end.positions, scene)


def quaternion_drift(scene: Scene, end: Trace, fly: Fly) -> float:
    """Largest angle, rad, between an orientation at the end and exp(spin · time) on that of the start.

    The reference turns in extended precision, by the phase less its whole turns: that of a long time or a fast spin has
    lost digits in plain floats. What a quaternion lacks of unit length counts as well.
    """
    spins, start = scene.bodies.spins, scene.bodies.quaternions.astype(np.longdouble)
    rates = np.sqrt((spins.astype(np.longdouble) ** 2).sum(axis=1))
    half = np.fmod(0.5 * rates * np.longdouble(end.time), 2 * np.longdouble(np.pi) + _PI_REST)
    axes = spins / np.where(rates > 0, rates, 1)[:, None]
    w, v = np.cos(half), np.sin(half)[:, None] * axes
    w0, v0 = start[:, 0], start[:, 1:]
    exact = np.column_stack([w * w0 - (v * v0).sum(axis=1), w[:, None] * v0 + w0[:, None] * v + np.cross(v, v0)])
    # the chord of two quaternions is half the angle between the rotations; both signs are the same rotation
    found = _turned(scene, end.time)
    chords = [np.sqrt(((found - sign * exact) ** 2).sum(axis=1)) for sign in (1, -1)]
    return float(2 * np.minimum(*chords).max(initial=0.0))


CHECKS: dict[str, Callable[[Scene, Trace, Fly], float]] = {
    "reversal_error": reversal_error,
    "relabelling_error": relabelling_error,
    "mirror_error": mirror_error,
    "scaling_error": scaling_error,
    "quaternion_drift": quaternion_drift,
}

# 2π less its nearest double; added in extended precision.
_PI_REST = np.longdouble("2.449293598294706414e-16")


def _turned(scene: Scene, time: float) -> Floats:
    """(n, 4): orientations at a time (s), as a run has them."""
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    trajectory.move_to(time)
    turned: Floats = trajectory.quaternions
    return turned


def _ordered(bodies: Bodies, order: Ints) -> Bodies:
    return Bodies(
        positions=bodies.positions[order],
        velocities=bodies.velocities[order],
        quaternions=bodies.quaternions[order],
        spins=bodies.spins[order],
        sizes=bodies.sizes[order],
        masses=bodies.masses[order],
    )


def _renumbered(scene: Scene) -> Pairs:
    """The ignored pairs of bodies that are numbered backwards."""
    pairs: Pairs = np.sort(len(scene.bodies) - 1 - scene.ignored, axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def _mirrored(mesh: Mesh, flip: Floats) -> Mesh:
    """The mirror image of the mesh; its faces run the other way round, so that outside stays outside."""
    hull = hull_of(mesh.hull.vertices * flip, mesh.hull.faces[:, ::-1])
    surface = hull_of(mesh.vertices * flip, mesh.faces[:, ::-1])
    return replace(mesh, vertices=surface.vertices, faces=surface.faces, hull=hull, digest=f"mirrored {mesh.digest}")


def _apart(found: Floats, expected: Floats, scene: Scene) -> float:
    """Largest distance between two places of a body, of the mean size; 0 without bodies."""
    distances = np.linalg.norm(found - expected, axis=1)
    return float(distances.max(initial=0.0) / scene.mean_size) if len(distances) else 0.0
