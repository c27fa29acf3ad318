"""What reported hits are worth, on contacts made up for it."""

import numpy as np
import pytest

from harness.motion.hits import Trace
from harness.reference.contacts import Contacts
from harness.reference.hit_errors import hit_errors

# The same pair touches four times, for .1, .2, .3 and .4 s.
ONSET, LENGTH = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.1, 0.2, 0.3, 0.4])
CONTACTS = Contacts.of_spheres(5.0, np.array([[0, 1]] * 4), ONSET, ONSET + LENGTH)


def reported(*times, walls=(), until=5.0):
    """A run with hits of the pair at these times, then of a wall."""
    rows = [(time, 0, 1, -1) for time in times] + [(time, 0, -1, 2) for time in walls]
    when, first, second, wall = np.array(rows, float).reshape(-1, 4).T
    bodies = np.column_stack([first, second]).astype(np.int64)
    return Trace(when, bodies, wall.astype(np.int64), until, np.zeros((2, 3)), np.zeros((2, 3)), 0.0, {})


def test_missed_extra_and_late_hits_are_shares_and_seconds():
    found = hit_errors(CONTACTS, 1e-15, reported(1.05, 3.15, 4.25, 4.9, walls=[0.5]), None)
    assert (found["reference_hits"], found["reference_error"]) == (4, 1e-15)
    assert (found["missed_hits"], found["extra_hits"]) == (0.25, 0.25)
    assert round(found["time_error"], 12) == 0.15
    assert "missed_hits_expected" not in found


def test_frames_are_expected_to_miss_contacts_as_often_as_these_are_shorter():
    found = hit_errors(CONTACTS, 0.0, reported(3.15, 4.25), 0.4)
    assert found["missed_hits_expected"] == pytest.approx(np.mean([0.75, 0.5, 0.25, 0.0]), rel=1e-15)
    # the variance of each is p (1 - p)
    deviation = np.sqrt(0.1875 + 0.25 + 0.1875)
    assert found["missed_hits_deviation"] == pytest.approx((2 - 1.5) / deviation, rel=1e-14)


def test_a_run_that_ended_early_is_not_judged_by_what_came_after():
    assert hit_errors(CONTACTS, 0.0, reported(1.05, until=1.5), None)["reference_hits"] == 1


def test_without_hits_no_time_error_is_told():
    assert set(hit_errors(CONTACTS, 0.0, reported(), None)) == {
        *("reference_hits", "reference_error", "missed_hits", "extra_hits")
    }
