"""Contacts of the event-driven method on a motion that others are asked about: proven, and a wrong one is caught."""

import pytest

from harness.compare import event_audit
from harness.compare.budget import Budget
from harness.compare.event_audit import audit_events
from tests.conftest import random_scene

NAME = "fcl/predictive"


def audited(shape, change=lambda onsets: onsets, monkeypatch=None):
    if monkeypatch is not None:
        whole = event_audit._EventAudit._onsets
        monkeypatch.setattr(event_audit._EventAudit, "_onsets", lambda self, law: change(whole(self, law)))
    return audit_events(random_scene(shape, 16, 2.6, seed=4), NAME, 60, 1 / 60, 1e-6, Budget())


def the_tally(found):
    (tally,) = found.tallies
    return tally


@pytest.mark.parametrize("shape", ["sphere", pytest.param("hull", marks=pytest.mark.slow)])
def test_every_contact_of_the_predictive_method_is_proven(shape):
    tally = the_tally(audited(shape))
    assert tally.verdicts > 40
    assert tally.agree == tally.verdicts


def test_contacts_that_are_left_out_are_proven_missed(monkeypatch):
    found = audited("sphere", lambda onsets: {}, monkeypatch)
    tally = the_tally(found)
    assert tally.real > 20
    assert tally.real == len(found.cases)
    assert {case.wrong for case in found.cases} == {NAME}
    assert all(case.judgement.touching for case in found.cases)


def test_contacts_that_are_told_too_early_are_proven_false(monkeypatch):
    def earlier(onsets):
        return {frame: {pair: time - 1e-3 for pair, time in told.items()} for frame, told in onsets.items()}

    found = audited("sphere", earlier, monkeypatch)
    assert the_tally(found).real > 20
    assert all(case.judgement.gap > 0 for case in found.cases)


def test_what_the_budget_leaves_out_is_said():
    budget = Budget(1e-9)
    audit_events(random_scene("sphere", 4, 3.0), NAME, 10, 1 / 60, 1e-6, budget)
    assert budget.left_out == [f"{NAME}: 11 of 11 frames not held against it"]
