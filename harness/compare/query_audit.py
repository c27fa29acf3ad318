"""What two methods tell of the pairs that they report: the counting that audits of gaps and of times have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from math import inf, isinf
from typing import NamedTuple

from harness.compare.isolated import Facts
from harness.compare.outcome import Case, Comparison
from harness.compare.pair_audit import KINDS, Kind, checked_pair
from harness.compare.poses import Pose
from harness.compare.query_answers import PairAnswers
from harness.compare.question import Question
from harness.compare.tally import CheckedAgreement, NamePair, Tally
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene


class Finding(NamedTuple):
    """What came of holding one answer against the truth.

    Attributes
    ----------
    kind : what explains that it is off; "real" if nothing does, and "undecided" also if it is right
    case : with the proof, where the kind is "real"
    """

    kind: Kind
    case: Case | None = None


RIGHT = Finding("undecided")


class QueryAudit(ABC):
    """The audit of two methods that tell a number of each pair; documented as `harness.compare.audit.Audit`.

    Each answer is held against the truth by itself, so that both may be wrong.

    Parameters
    ----------
    names, scene, facts, question, flown : as for `harness.compare.audit.audit_of`
    """

    def __init__(
        self, names: NamePair, scene: Scene, facts: tuple[Facts, Facts], question: Question, *, flown: bool
    ) -> None:
        self._names, self._scene, self._facts, self._question = names, scene, facts, question
        self._flown = flown
        self._tally = Tally(names, scene.shape, query=question.query)
        self._checked = CheckedAgreement(names, scene.shape, query=question.query)
        self.found = Comparison(tallies=[self._tally], checked=[self._checked])

    def add(self, truths: Truths, query_index: int, answers: tuple[PairAnswers, PairAnswers]) -> None:
        pairs = self._scene.pair_count
        told = {pair: both(answers, pair) for pair in sorted(set(answers[0]) | set(answers[1]))}
        differing = [pair for pair, numbers in told.items() if self._differ(truths.pose, pair, numbers)]
        self._tally.poses += 1
        self._tally.verdicts += pairs
        self._tally.agree += pairs - len(differing)
        for pair in differing:
            numbers = told[pair]
            findings = [
                self._finding(truths, query_index, pair, place, numbers[place], numbers[1 - place]) for place in (0, 1)
            ]
            kind = max((finding.kind for finding in findings), key=KINDS.index)
            setattr(self._tally, kind, getattr(self._tally, kind) + 1)
            self.found.cases += [finding.case for finding in findings if finding.case is not None]
        self._check_agreement(truths, query_index, answers, differing)

    def _check_agreement(
        self, truths: Truths, query_index: int, answers: tuple[PairAnswers, PairAnswers], differing: list[Pair]
    ) -> None:
        """Judge one of the answers that both agree on, at every n-th query."""
        pair = checked_pair(
            self._scene, truths.pose, query_index, flown=self._flown, within=self._asked_within(truths.pose)
        )
        if pair is None or pair in differing:
            return
        self._checked.verdicts += 1
        numbers, beside = both(answers, pair), self._beside_agreement(truths.pose)
        findings = [self._finding(truths, query_index, pair, place, numbers[place], beside) for place in (0, 1)]
        wrong = [finding.case for finding in findings if finding.case is not None]
        if wrong:
            self._checked.contradicted += 1
            self.found.shared.append(replace(wrong[0], wrong=" and ".join(case.wrong for case in wrong)))

    def _differ(self, pose: Pose, pair: Pair, numbers: tuple[float, float]) -> bool:
        """Whether two answers say different things; inf stands for a pair that is not reported."""
        if isinf(numbers[0]) or isinf(numbers[1]):
            return isinf(numbers[0]) != isinf(numbers[1])
        return self._apart(pose, pair, abs(numbers[0] - numbers[1]))

    @abstractmethod
    def _apart(self, pose: Pose, pair: Pair, difference: float) -> bool:
        """Whether two numbers differ by more than either method declares."""

    @abstractmethod
    def _asked_within(self, pose: Pose) -> float:
        """m, how far apart the bounding spheres of a pair may be of which agreement is checked."""

    @abstractmethod
    def _beside_agreement(self, pose: Pose) -> float:
        """What stands for the other's answer where both agree."""

    @abstractmethod
    def _finding(self, truths: Truths, query_index: int, pair: Pair, place: int, told: float, other: float) -> Finding:
        """What is proven against the answer of the method at a place in `names`, with the help of the other's."""


def both(answers: tuple[PairAnswers, PairAnswers], pair: Pair) -> tuple[float, float]:
    """What either tells of a pair; inf where it is not reported."""
    return answers[0].get(pair, inf), answers[1].get(pair, inf)
