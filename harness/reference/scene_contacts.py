"""Every contact of a scene whose bodies pass through each other (`response: none`), and how wrong its times may be."""

from __future__ import annotations

from harness.reference.contacts import Contacts
from harness.reference.solid_contacts import solid_contacts
from harness.reference.solid_onset_error import solid_onset_error
from harness.reference.sphere_contacts import sphere_contacts
from harness.reference.sphere_onset_error import sphere_onset_error
from harness.scene.scene import Scene


def scene_contacts(scene: Scene, duration: float, tolerance: float) -> Contacts:
    """All contacts of a scene whose bodies pass through each other.

    Parameters
    ----------
    scene : of the shape that is asked about
    duration : s
    tolerance : of the mean size of a pair; hulls and surfaces that are nearer touch. No effect on spheres, whose
        times are solved in closed form.

    Raises
    ------
    InputError
        If a contact of hulls or surfaces cannot be followed.
    """
    if scene.shape == "sphere":
        return sphere_contacts(scene.bodies, scene.box, duration).encounters_without(scene.ignored)
    return solid_contacts(scene, duration, tolerance)


def onset_error(scene: Scene, contacts: Contacts) -> float:
    """The largest error (s) found among the onsets of a sample of contacts.

    Of spheres in arithmetic of fifty digits, of hulls and surfaces by what FCL answers around the onset.
    """
    if scene.shape == "sphere":
        return sphere_onset_error(scene.bodies, scene.box, contacts)
    return solid_onset_error(scene, contacts)
