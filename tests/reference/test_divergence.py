"""When two motions part: made-up histories."""

from math import inf

import numpy as np

from harness.reference.divergence import first_divergence
from harness.reference.events import Events


def events(*found):
    """(time, i, j) for a pair, (time, i, "x+") for a wall."""
    walls = [("x-", "x+", "y-", "y+", "z-", "z+").index(b) if isinstance(b, str) else -1 for _, _, b in found]
    pairs = [(a, -1 if isinstance(b, str) else b) for _, a, b in found]
    return Events(
        np.array([time for time, *_ in found], float),
        np.array(pairs, int).reshape(-1, 2),
        np.array(walls, int).reshape(-1),
    )


def parted(first, second, bodies=4):
    there, back = first_divergence(bodies, first, second), first_divergence(bodies, second, first)
    assert there == back
    return there


def test_equal_histories_never_part_whatever_their_times():
    assert parted(events((1, 0, 1), (2, 0, "x+")), events((1.1, 0, 1), (2.1, 0, "x+"))) == inf
    assert parted(events(), events()) == inf


def test_another_partner_is_a_divergence_at_the_earlier_of_the_two_times():
    assert parted(events((1, 0, 1), (2, 0, 2)), events((1.1, 0, 1), (2.5, 0, 3))) == 2


def test_a_missed_hit_is_a_divergence():
    assert parted(events((1, 0, 1), (2, 2, 3), (3, 0, 1)), events((1, 0, 1), (3, 0, 1))) == 2
    assert parted(events((1, 0, 1), (2, 0, "x+")), events((1, 0, 1))) == 2


def test_the_order_of_hits_that_share_no_body_does_not_matter():
    assert parted(events((1.00, 2, 3), (1.01, 0, 1)), events((1.02, 0, 1), (1.02, 2, 3))) == inf


def test_the_order_of_hits_that_share_a_body_does():
    assert parted(events((1.00, 0, 2), (1.01, 0, 1)), events((1.02, 0, 1), (1.02, 0, 2))) == 1


def test_walls_of_two_axes_may_change_places_but_not_around_a_hit():
    assert parted(events((1, 0, "x+"), (1.1, 0, "y-")), events((1.2, 0, "y-"), (1.2, 0, "x+"))) == inf
    assert parted(events((1, 0, "x+"), (1.1, 0, "x-")), events((1.2, 0, "x-"), (1.2, 0, "x+"))) == 1
    between = events((1, 0, "x+"), (2, 0, 1), (3, 0, "y-"))
    assert parted(between, events((1, 0, "y-"), (2, 0, 1), (3, 0, "x+"))) == 1
