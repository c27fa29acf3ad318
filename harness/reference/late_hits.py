"""Which reported times of impact are late: an early answer is safe, a late one is not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.motion.hits import Trace
from harness.motion.kinematics import Trajectory
from harness.reference.contacts import Contacts
from harness.reference.matching import match
from harness.reference.near_pairs import pair_bounds
from harness.scene.scene import Scene

# Of a size: how far the fastest points may move in the time over which the closing speed is measured.
_STEP = 1e-4


class _Hit(NamedTuple):
    """A hit of the reference: its pair, and its onset (s)."""

    i: int
    j: int
    onset: float


def late_hits(
    scene: Scene, contacts: Contacts, reported: Trace, tolerance: float, reference_tolerance: float
) -> float | None:
    """Hits reported later than the truth by more than a length at the closing speed, of the matched hits.

    Parameters
    ----------
    scene : of the reference's shape
    contacts : of the reference
    reported : what the run reported
    tolerance : the length, of the mean size of a pair
    reference_tolerance : of the mean size, the gap at which the reference takes bodies for touching, so that it may be
        early

    Returns
    -------
    The share of late hits; None without any matched hit.
    """
    between = reported.walls < 0
    until = min(contacts.duration, reported.time)
    found = match(contacts, reported.times[between], reported.bodies[between], until)
    if not len(found.errors):
        return None
    speeds, sizes = _fastest(scene), scene.bodies.sizes
    trajectory, late = Trajectory(scene.bodies, scene.box, folded=True, turning=True), 0
    for contact, seconds in zip(found.matched.tolist(), found.errors.tolist(), strict=True):
        i, j = contacts.pairs[contacts.encounter[contact]].tolist()
        lengths = tolerance + (reference_tolerance if scene.shape != "sphere" else 0.0)
        allowed, fastest = lengths * 0.5 * float(sizes[i] + sizes[j]), float(speeds[i] + speeds[j])
        if seconds * fastest <= allowed:
            continue  # no points of theirs move as far in that time
        hit = _Hit(i, j, float(contacts.onset[contact]))
        late += seconds * _closing_speed(scene, trajectory, hit, fastest) > allowed
    return late / len(found.errors)


def _closing_speed(scene: Scene, trajectory: Trajectory, hit: _Hit, fastest: float) -> float:
    """m/s, at which the gap of a pair has closed just before it touched."""
    step = min(hit.onset, _STEP * float(scene.bodies.sizes[[hit.i, hit.j]].mean()) / fastest)
    trajectory.move_to(hit.onset)
    gap = pair_bounds(scene, trajectory, hit.i, hit.j).upper
    trajectory.move_to(hit.onset - step)
    return (pair_bounds(scene, trajectory, hit.i, hit.j).upper - gap) / step


def _fastest(scene: Scene) -> Floats:
    """(n,) m/s: no point of a body is faster."""
    bodies = scene.bodies
    turning = np.linalg.norm(bodies.spins, axis=1) * bodies.radii if scene.shape != "sphere" else 0.0
    speeds: Floats = np.linalg.norm(bodies.velocities, axis=1) + turning
    return speeds
