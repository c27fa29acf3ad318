"""The reference of replayed motion (`response: none`): every contact of every pair, and how far its times are right."""

from __future__ import annotations

from harness.measure.contacts import Contacts
from harness.motion.encounters import sphere_contacts
from harness.motion.precise import largest_error
from harness.scene.scene import Scene


def contacts_of(scene: Scene, duration: float, tolerance: float) -> Contacts:
    """All contacts of a scene whose bodies pass through each other.

    Parameters
    ----------
    scene : of the shape that is asked about
    duration : s
    tolerance : of size; surfaces of hulls and meshes that are nearer touch. No effect on spheres, whose times are
        solved in closed form.
    """
    return sphere_contacts(scene.bodies, scene.box, duration)


def error_of(scene: Scene, contacts: Contacts) -> float:
    """The largest error (s) found among the onsets of a sample of contacts, in high-precision arithmetic."""
    return largest_error(scene.bodies, scene.box, contacts)
