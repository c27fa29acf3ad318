"""What judges the answers of two methods to a query: one audit a query, all of the same form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Protocol

from harness.compare.gap_audit import GapAudit, differing_gap
from harness.compare.impact_audit import ImpactAudit, differing_time
from harness.compare.isolated import Facts
from harness.compare.outcome import Comparison
from harness.compare.pair_audit import PairAudit, differing_verdict
from harness.compare.poses import Pose
from harness.compare.query_answers import PairAnswers
from harness.compare.question import Question
from harness.compare.tally import NamePair
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene
from harness.vocabulary import Query


class Audit(Protocol):
    """The audit of two methods, pose after pose.

    Attributes
    ----------
    found : what has been found so far
    """

    found: Comparison

    def add(self, truths: Truths, query_index: int, answers: tuple[PairAnswers, PairAnswers]) -> None:
        """Count the answers of both at a pose, or in a frame.

        Parameters
        ----------
        truths : what is true there
        query_index : which query of this scene it was, from 1
        answers : what each tells of the pairs that it reports
        """


class _MakesAudit(Protocol):
    def __call__(
        self, names: NamePair, scene: Scene, facts: tuple[Facts, Facts], question: Question, *, flown: bool
    ) -> Audit: ...


class _FindsDifference(Protocol):
    def __call__(
        self, question: Question, facts: Facts, scene: Scene, pose: Pose, answer: PairAnswers, other: PairAnswers
    ) -> Pair | None: ...


class _OfQuery(NamedTuple):
    """What audits the answers to a query, and what finds the first pair of which two answers differ."""

    audit: _MakesAudit
    difference: _FindsDifference


_AUDITS: Mapping[Query, _OfQuery] = {
    "collision": _OfQuery(PairAudit, differing_verdict),
    "tolerance": _OfQuery(GapAudit, differing_gap),
    "distance": _OfQuery(GapAudit, differing_gap),
    "impact": _OfQuery(ImpactAudit, differing_time),
}


def audit_of(names: NamePair, scene: Scene, facts: tuple[Facts, Facts], question: Question, *, flown: bool) -> Audit:
    """The audit of a query.

    Parameters
    ----------
    names : of both methods
    scene : with the hulls that both are held against
    facts : what each declares of itself
    question : what both are asked
    flown : whether the bodies fly; else they are put where verdicts are hard
    """
    return _AUDITS[question.query].audit(names, scene, facts, question, flown=flown)


def changed_pair(
    question: Question, facts: Facts, scene: Scene, pose: Pose, answer: PairAnswers, other: PairAnswers
) -> Pair | None:
    """The first pair of which a method tells another thing than before, by more than the tolerance that it declares."""
    return None if answer == other else _AUDITS[question.query].difference(question, facts, scene, pose, answer, other)
