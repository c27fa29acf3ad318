"""How wrong the computed onsets of hulls and surfaces are: a sample of them, put to FCL around the onset.

FCL tells whether two bodies touch at a moment, by other means than those that found the contact. An onset is off by at
most the time before which FCL finds the bodies apart and after which it finds them touching.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.motion.kinematics import Trajectory
from harness.reference.contacts import Contacts
from harness.scene.scene import Scene

SAMPLE = 64
# The times tried: the first, of the duration, and the factor from one to the next.
FIRST, FACTOR = 1e-14, 4.0


def solid_onset_error(scene: Scene, contacts: Contacts) -> float:
    """The largest such bound (s) over a sample of contacts, at most the contact's length; 0 without any contact.

    Parameters
    ----------
    scene : of shape `hull` or `mesh`
    contacts : of the scene
    """
    import fcl  # only where a reference is made

    from harness.backends.fcl_objects import FclObjects

    bodies = FclObjects(scene)
    trajectory = Trajectory(scene.bodies, scene.box, folded=True, turning=True)
    request, result = fcl.CollisionRequest(), fcl.CollisionResult()

    def touching(i: int, j: int, time: float) -> bool:
        trajectory.move_to(time)
        bodies.place(trajectory.positions, trajectory.quaternions, np.array([i, j]))
        return bool(fcl.collide(bodies.objects[i], bodies.objects[j], request, result))

    worst = 0.0
    for contact in _chosen(contacts.onset):
        i, j = contacts.pairs[contacts.encounter[contact]].tolist()
        onset, length = float(contacts.onset[contact]), float(contacts.lengths[contact])
        offset = FIRST * contacts.duration
        while offset < length and not (touching(i, j, onset + offset) and not touching(i, j, onset - offset)):
            offset *= FACTOR
        worst = max(worst, min(offset, length))
    return worst


def _chosen(onset: Floats) -> list[int]:
    """Contacts that begin after time 0, spread over the duration."""
    begins = np.flatnonzero(onset > 0.0)
    begins = begins[np.argsort(onset[begins], kind="stable")]
    if not len(begins):
        return []
    chosen: list[int] = begins[np.unique(np.linspace(0, len(begins) - 1, SAMPLE).astype(np.int64))].tolist()
    return chosen
