"""Hits matched with contacts: made-up sequences whose answer can be seen."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.reference.contacts import Contacts
from harness.reference.matching import match


def spheres(*contacts, duration=10.0):
    """Contacts (pair, onset, release) of spheres."""
    ordered = sorted(contacts)
    times = np.array([(begin, end) for _, begin, end in ordered], float).reshape(-1, 2)
    return Contacts.of_spheres(
        duration, np.array([pair for pair, *_ in ordered], int).reshape(-1, 2), times[:, 0], times[:, 1]
    )


def hits(*found, until=10.0, of):
    """Matching of hits (pair, time) with contacts."""
    return match(
        of, np.array([time for _, time in found], float), np.array([p for p, _ in found], int).reshape(-1, 2), until
    )


def summary(matching):
    return matching.hits, matching.missed, matching.extra, matching.errors.round(9).tolist()


A, B, C = (0, 1), (0, 2), (1, 2)


@pytest.mark.slow
def test_each_hit_is_matched_with_the_contact_it_falls_into():
    contacts = spheres((A, 1, 2), (B, 1.5, 3), (A, 4, 5))
    assert summary(hits((A, 1.25), (B, 1.75), (A, 4.5), of=contacts)) == (3, 0, 0, [0.25, 0.5, 0.25])


def test_the_order_in_which_simultaneous_hits_are_listed_does_not_matter():
    contacts = spheres((A, 1, 2), (B, 1, 2), (C, 1, 2))
    assert summary(hits((C, 1.5), (A, 1.5), (B, 1.5), of=contacts)) == (3, 0, 0, [0.5, 0.5, 0.5])


def test_a_contact_between_two_frames_is_missed():
    assert summary(hits((A, 4.5), of=spheres((A, 1, 1.01), (A, 4, 5)))) == (2, 1, 0, [0.5])


def test_a_hit_of_a_pair_that_does_not_touch_is_extra():
    assert summary(hits((A, 1.5), (C, 1.5), of=spheres((A, 1, 2)))) == (1, 0, 1, [0.5])


def test_a_hit_outside_of_every_contact_is_extra_and_its_contact_missed():
    assert summary(hits((A, 2.5), of=spheres((A, 1, 2), (A, 3, 4)))) == (2, 2, 1, [])


def test_a_contact_reported_twice_is_one_match_and_one_extra():
    assert summary(hits((A, 1.25), (A, 1.75), of=spheres((A, 1, 2)))) == (1, 0, 1, [0.25])


def test_no_hits_and_no_contacts():
    assert summary(hits(of=spheres())) == (0, 0, 0, [])
    assert summary(hits(of=spheres((A, 1, 2)))) == (1, 1, 0, [])
    nothing = hits((A, 1.0), (A, 2.0), of=spheres())
    assert (nothing.missed_share, nothing.extra_share) == (0.0, 2.0)


def test_what_touches_already_at_the_start_may_be_reported_or_not():
    contacts = spheres((A, 0, 2), (B, 1, 2))
    assert summary(hits((A, 0.5), (B, 1.5), of=contacts)) == (1, 0, 0, [0.5])
    assert summary(hits((B, 1.5), of=contacts)) == (1, 0, 0, [0.5])
    assert summary(hits((A, 0.5), (A, 0.75), of=spheres((A, 0, 2)))) == (0, 0, 1, [])


def test_contacts_that_begin_when_nobody_watches_any_more_do_not_count():
    contacts = spheres((A, 1, 2), (B, 9.5, 10))
    assert summary(hits((A, 1.5), of=contacts, until=9.0)) == (1, 0, 0, [0.5])
    assert summary(hits((A, 1.5), (B, 11.0), of=contacts, until=12.0)) == (2, 1, 0, [0.5])


def test_a_report_at_the_very_ends_of_a_contact_is_one_also_after_rounding():
    for time in (1 - 1e-13, 1, 2, 2 + 1e-13):
        assert hits((A, time), of=spheres((A, 1, 2))).missed == 0
    grazing = spheres((A, 1, 1))
    assert hits((A, 1 + 1e-13), of=grazing).missed == 0


def encounter(*contacts, begin=1.0, end=4.0):
    """One encounter of the pair A, in which its meshes touch at these times."""
    times = np.array(contacts, float).reshape(-1, 2)
    return Contacts(
        10.0, np.array([A]), np.array([begin]), np.array([end]), np.zeros(len(times), int), times[:, 0], times[:, 1]
    )


def test_a_shape_larger_than_the_reference_reports_early_and_takes_two_contacts_for_one():
    assert summary(hits((A, 1.0), of=encounter((2, 2.5), (3, 3.5)))) == (2, 1, 0, [-1.0])


def test_spheres_that_meet_where_their_meshes_do_not_are_extra():
    assert summary(hits((A, 1.0), of=encounter())) == (0, 0, 1, [])


def test_a_contact_that_has_ended_is_not_reported_by_a_later_hit():
    assert summary(hits((A, 3.25), of=encounter((2, 2.01), (3, 3.5)))) == (2, 1, 0, [0.25])
    assert summary(hits((A, 3.1), (A, 3.25), of=encounter((2, 2.01), (3, 3.5)))) == (2, 1, 1, [0.1])


def test_an_early_report_of_the_second_contact_leaves_the_first_to_its_own():
    assert summary(hits((A, 2.1), (A, 2.9), of=encounter((2, 2.5), (3, 3.5)))) == (2, 0, 0, [0.1, -0.1])


@given(
    st.lists(st.integers(0, 30), unique=True, max_size=8),
    st.lists(st.integers(0, 30), unique=True, max_size=4),
)
def test_within_an_encounter_the_matching_is_the_best_there_is(ends, reports):
    """Against all ordered one-to-one matchings, one by one."""
    ends = sorted(ends)[: len(ends) // 2 * 2]
    contacts = [(begin / 10 + 1, end / 10 + 1) for begin, end in zip(ends[::2], ends[1::2], strict=True)]
    times = [time / 10 + 1 for time in sorted(reports)]
    best = (0, 0.0)
    for k in range(1, min(len(contacts), len(times)) + 1):
        for some in combinations(contacts, k):
            for chosen in combinations(times, k):
                if all(time <= end + 1e-9 for (_, end), time in zip(some, chosen, strict=True)):
                    cost = sum(abs(time - begin) for (begin, _), time in zip(some, chosen, strict=True))
                    best = max(best, (k, -cost))
    found = hits(*((A, time) for time in times), of=encounter(*contacts))
    assert len(found.errors) == best[0]
    assert np.abs(found.errors).sum() == pytest.approx(-best[1], abs=1e-9)
    assert found.hits == len(contacts)
    assert found.missed == len(contacts) - best[0]
    assert found.extra == len(times) - best[0]
