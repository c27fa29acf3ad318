"""The reference of replayed motion (`response: none`): every contact of every pair, and how far its times are right."""

from __future__ import annotations

from harness.reference.contacts import Contacts
from harness.reference.solid_contacts import solid_contacts
from harness.reference.solid_onset_error import largest_bracket
from harness.reference.sphere_contacts import sphere_contacts
from harness.reference.sphere_onset_error import largest_error
from harness.scene.scene import Scene


def contacts_of(scene: Scene, duration: float, tolerance: float) -> Contacts:
    """All contacts of a scene whose bodies pass through each other.

    Parameters
    ----------
    scene : of the shape that is asked about
    duration : s
    tolerance : of the mean size of a pair; hulls and surfaces that are nearer touch. No effect on spheres, whose
        times are solved in closed form.
    """
    if scene.shape == "sphere":
        return sphere_contacts(scene.bodies, scene.box, duration)
    return solid_contacts(scene, duration, tolerance)


def error_of(scene: Scene, contacts: Contacts) -> float:
    """The largest error (s) found among the onsets of a sample of contacts.

    Of spheres in high-precision arithmetic, of hulls and surfaces by what FCL sees around them.
    """
    if scene.shape == "sphere":
        return largest_error(scene.bodies, scene.box, contacts)
    return largest_bracket(scene, contacts)
