"""The check by FCL around the onset."""

import pytest

from harness.reference.solid_contacts import solid_contacts
from harness.reference.solid_onset_error import solid_onset_error
from tests.conftest import random_scene


@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_good_times_are_found_good_and_late_ones_late(shape):
    scene = random_scene(shape, 8, 3.0, seed=4)
    found = solid_contacts(scene, 2.0, 1e-10)
    assert solid_onset_error(scene, found) < 1e-8
    found.onset[found.onset > 0] += 1e-5
    assert solid_onset_error(scene, found) >= 1e-5
