"""The gaps that two methods tell, or the pairs that they say are near: where they differ, the exact distance decides.

Each answer is held against the certified distance by itself, so that both may be wrong. An answer is wrong if it is off
by more than its method declares, and by more than the numbers can hold.
"""

from __future__ import annotations

from math import inf, isinf

from harness.compare.certificate import Judgement
from harness.compare.exact_gap import ExactGap
from harness.compare.isolated import Facts
from harness.compare.outcome import Case, Comparison
from harness.compare.pair_audit import KINDS, Kind, band, band_of, checked_pair
from harness.compare.poses import Pose
from harness.compare.query_answers import Told
from harness.compare.question import Question
from harness.compare.tally import CheckedAgreement, NamePair, Tally
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene


class GapAudit:
    """The audit of two methods asked "tolerance" or "distance"; documented as `harness.compare.audit.Audit`.

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

    def add(self, truths: Truths, query_index: int, answers: tuple[Told, Told]) -> None:
        pairs = self._scene.pair_count
        told = {pair: _both(answers, pair) for pair in sorted(set(answers[0]) | set(answers[1]))}
        differing = [pair for pair, gaps in told.items() if self._differ(truths.pose, pair, gaps)]
        self._tally.poses += 1
        self._tally.verdicts += pairs
        self._tally.agree += pairs - len(differing)
        for pair in differing:
            kinds = [self._kind(truths, pair, place, told[pair][place]) for place in (0, 1)]
            kind = max(kinds, key=KINDS.index)
            setattr(self._tally, kind, getattr(self._tally, kind) + 1)
            for place in (0, 1):
                if kinds[place] == "real":
                    name, gap = self._names[place], told[pair][place]
                    self.found.cases.append(self._case(name, pair, gap, truths, query_index))
        self._check_agreement(truths, query_index, answers, differing)

    def _differ(self, pose: Pose, pair: Pair, gaps: tuple[float, float]) -> bool:
        if isinf(gaps[0]) or isinf(gaps[1]):
            return isinf(gaps[0]) != isinf(gaps[1])
        bands = (band(self._scene, facts.tolerance, pose, pair) for facts in self._facts)
        return abs(gaps[0] - gaps[1]) > max(bands)

    def _check_agreement(
        self, truths: Truths, query_index: int, answers: tuple[Told, Told], differing: list[Pair]
    ) -> None:
        """Judge one of the answers that both agree on, at every n-th query."""
        within = self._question.within
        pair = checked_pair(self._scene, truths.pose, query_index, flown=self._flown, within=within)
        if pair is None or pair in differing:
            return
        self._checked.verdicts += 1
        told = _both(answers, pair)
        wrong = [place for place in (0, 1) if self._kind(truths, pair, place, told[place]) == "real"]
        if wrong:
            self._checked.contradicted += 1
            names = " and ".join(self._names[place] for place in wrong)
            self.found.shared.append(self._case(names, pair, told[wrong[0]], truths, query_index))

    def _kind(self, truths: Truths, pair: Pair, place: int, told: float) -> Kind:
        """What explains that an answer is off; "real" if nothing does, and "undecided" also if it is right."""
        facts, shape = self._facts[place], self._scene.shape
        allowed = band_of(self._scene, facts, self._facts[1 - place], truths.pose, pair)
        if self._off_by(truths.gap(pair, shape), told) <= allowed:
            return "undecided"
        if told == 0.0 and facts.solid and truths.judgement(pair).contained:
            return "containment"
        # a hull in the place of a mesh may have another gap than the mesh, but must have that of the hull
        if facts.approximated is not None and self._off_by(truths.gap(pair, "hull"), told) <= allowed:
            return "approximation"
        return "real"

    def _off_by(self, exact: ExactGap, told: float) -> float:
        """m"""
        within = self._question.within
        if self._question.query == "distance" and not isinf(told):
            return exact.off_by(told)
        near = exact.at_most(within)
        return 0.0 if near is None or near == (not isinf(told)) else abs(exact.value - within)

    def _case(self, wrong: str, pair: Pair, told: float, truths: Truths, query_index: int) -> Case:
        exact = truths.gap(pair, self._scene.shape)
        exact.check()  # before a method is accused
        return Case(
            self._names,
            wrong,
            pair,
            Judgement(exact.value == 0.0, exact.value, exact.certificate),
            scene=self._scene,
            pose=truths.pose,
            query_index=query_index,
            question=self._question,
            told=told,
        )


def differing_gap(question: Question, facts: Facts, scene: Scene, pose: Pose, answer: Told, other: Told) -> Pair | None:
    """The first pair whose gap is told another, or that only one answer has, by more than the tolerance."""
    truths = Truths(scene, pose)
    for pair in sorted(set(answer) | set(other)):
        one, another = _both((answer, other), pair)
        if isinf(one) or isinf(another):
            # what is as far apart as is asked about may be told or not
            off = abs(truths.gap(pair, scene.shape).value - question.within)
        else:
            off = abs(one - another)
        if one != another and off > band(scene, facts.tolerance, pose, pair):
            return pair
    return None


def _both(answers: tuple[Told, Told], pair: Pair) -> tuple[float, float]:
    return answers[0].get(pair, inf), answers[1].get(pair, inf)
