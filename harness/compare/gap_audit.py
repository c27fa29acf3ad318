"""The gaps that two methods tell, or the pairs that they say are near: where they differ, the exact distance decides.

Each answer is held against the certified distance by itself, so that both may be wrong. An answer is wrong if it is off
by more than its method declares, and by more than the numbers can hold.
"""

from __future__ import annotations

from math import inf, isinf

from harness.compare.certificate import Judgement
from harness.compare.exact_gap import ExactGap
from harness.compare.isolated import Facts
from harness.compare.outcome import Case
from harness.compare.pair_audit import Kind, band, band_of
from harness.compare.poses import Pose
from harness.compare.query_answers import PairAnswers
from harness.compare.query_audit import Finding, QueryAudit, both
from harness.compare.question import Question
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene


class GapAudit(QueryAudit):
    """The audit of two methods asked "tolerance" or "distance"."""

    def _apart(self, pose: Pose, pair: Pair, difference: float) -> bool:
        return difference > max(band(self._scene, facts.allowed, pose, pair) for facts in self._facts)

    def _asked_within(self, pose: Pose) -> float:
        return self._question.within

    def _beside_agreement(self, pose: Pose) -> float:
        return inf  # no gap is judged by another

    def _finding(self, truths: Truths, query_index: int, pair: Pair, place: int, told: float, other: float) -> Finding:
        kind = self._kind(truths, pair, place, told)
        return Finding(kind, self._case(place, pair, told, truths, query_index) if kind == "real" else None)

    def _kind(self, truths: Truths, pair: Pair, place: int, told: float) -> Kind:
        """What explains that an answer is off."""
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

    def _case(self, place: int, pair: Pair, told: float, truths: Truths, query_index: int) -> Case:
        exact = truths.gap(pair, self._scene.shape)
        exact.check()  # before a method is accused
        return Case(
            self._names,
            self._names[place],
            pair,
            Judgement(exact.value == 0.0, exact.value, exact.certificate),
            scene=self._scene,
            pose=truths.pose,
            query_index=query_index,
            question=self._question,
            told=told,
        )


def differing_gap(
    question: Question, facts: Facts, scene: Scene, pose: Pose, answer: PairAnswers, other: PairAnswers
) -> Pair | None:
    """The first pair whose gap is told another, or that only one answer has, by more than the tolerance."""
    truths = Truths(scene, pose)
    for pair in sorted(set(answer) | set(other)):
        one, another = both((answer, other), pair)
        if isinf(one) or isinf(another):
            # what is as far apart as is asked about may be told or not
            off = abs(truths.gap(pair, scene.shape).value - question.within)
        else:
            off = abs(one - another)
        if one != another and off > band(scene, facts.allowed, pose, pair):
            return pair
    return None
