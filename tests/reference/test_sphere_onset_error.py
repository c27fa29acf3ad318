"""The check in fifty digits."""

import numpy as np
import pytest

from harness.reference.sphere_contacts import sphere_contacts
from harness.reference.sphere_onset_error import sphere_onset_error
from harness.scene.box import Box
from tests.conftest import make_bodies
from tests.reference.gas import gas


def test_good_times_are_found_good_and_a_wrong_one_as_wrong_as_it_is():
    bodies, box = gas(7)
    found = sphere_contacts(bodies, box, 20.0)
    assert sphere_onset_error(bodies, box, found) < 1e-12
    found.onset[found.onset.argmax()] += 1e-9
    assert sphere_onset_error(bodies, box, found) == pytest.approx(1e-9, rel=1e-3)


def test_without_contacts_there_is_no_error():
    bodies, box = make_bodies([[0, 0, 0]], [[1, 1, 1]]), Box(np.full(3, 9.0))
    assert sphere_onset_error(bodies, box, sphere_contacts(bodies, box, 1.0)) == 0.0
