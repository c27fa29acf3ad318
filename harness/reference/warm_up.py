"""Compile every kernel of this folder, and import what it needs, before a clock runs."""

from __future__ import annotations

import numpy as np

from harness.reference.divergence import first_divergence
from harness.reference.events import Events
from harness.reference.matching import match
from harness.reference.positions_from_hits import positions_at
from harness.reference.scene_contacts import scene_contacts
from harness.scene.scene import Scene


def warm_up_reference(scene: Scene) -> None:
    """Compile and import what references and errors need for a shape.

    Parameters
    ----------
    scene : of the shape, with two bodies that meet
    """
    import scipy.spatial  # noqa: F401

    contacts = scene_contacts(scene, 1.0, 1e-6)
    match(contacts, contacts.onset, contacts.pairs[contacts.encounter], 1.0)
    events = Events(contacts.onset, contacts.pairs[contacts.encounter], np.full(len(contacts), -1))
    first_divergence(len(scene.bodies), events, events)
    positions_at(np.ones(1), scene.bodies, events, "elastic", 1.0)
