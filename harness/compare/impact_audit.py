"""When two methods say that pairs begin to touch in a frame: where they differ, exact verdicts at instants decide.

A method that says a time is wrong if the bodies are proven to be apart at that time, by more than its tolerance: it is
early, or the hit is none. A method that says a later time, or none, is wrong if they are proven to be apart at the
start of the frame and, at an instant before the time that it says, to be in each other deeper than its tolerance: it is
late, or the hit is missed. So each accusation is a proof or two, and no search for the true time is believed.
"""

from __future__ import annotations

from math import isinf

import numpy as np

from harness.compare.certificate import Judgement
from harness.compare.isolated import Facts
from harness.compare.outcome import Case
from harness.compare.pair_audit import Kind, band, band_of
from harness.compare.poses import Frame, Pose
from harness.compare.query_answers import PairAnswers
from harness.compare.query_audit import RIGHT, Finding, QueryAudit, both
from harness.compare.question import Question
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene

# Instants between two times that are looked at for a proof that bodies touch: each halves what is left to the first.
_HALVINGS = 24
# Of the way of the fastest points: what a time, and the places at it, are rounded by.
_ROUNDING = 1e-12


class ImpactAudit(QueryAudit):
    """The audit of two methods asked "impact"."""

    def _apart(self, pose: Pose, pair: Pair, difference: float) -> bool:
        allowed = max(band(self._scene, facts.allowed, pose, pair) for facts in self._facts)
        return difference * _fastest(self._scene, _frame(pose), pair) > allowed

    def _asked_within(self, pose: Pose) -> float:
        frame = _frame(pose)
        return 2.0 * frame.duration * float(np.linalg.norm(frame.velocities, axis=1).max(initial=0.0))

    def _beside_agreement(self, pose: Pose) -> float:
        return _frame(pose).duration  # of what neither reports: whether they are in each other at the end

    def _finding(self, truths: Truths, query_index: int, pair: Pair, place: int, told: float, other: float) -> Finding:
        frame = _frame(truths.pose)
        allowed = self._allowed(frame, pair, place)

        def case(truth: Judgement, moment: float) -> Case:
            return Case(
                self._names,
                self._names[place],
                pair,
                truth,
                scene=self._scene,
                pose=frame,
                query_index=query_index,
                question=self._question,
                told=told,
                moment=moment,
            )

        if not isinf(told):
            there = truths.later(told)
            truth = there.judgement(pair)
            if truth.gap > allowed:
                kind = self._explained(there, pair, place, allowed)
                return Finding(kind, case(truth, told) if kind == "real" else None)
        if other >= told or truths.judgement(pair).gap <= allowed:
            return RIGHT  # nothing is said of what touches at the start, until it has parted
        last = min(told, frame.duration)
        instants = (other + (last - other) * 0.5**power for power in range(_HALVINGS + 1))
        for instant in instants if other < last else (last,):
            truth = truths.later(instant).judgement(pair)
            if truth.touching and truth.gap < -allowed:
                kind = self._explained(truths, pair, place, allowed)
                return Finding(kind, case(truth, instant) if kind == "real" else None)
        return RIGHT

    def _explained(self, there: Truths, pair: Pair, place: int, allowed: float) -> Kind:
        """Whether a hull in the place of a mesh, or a solid in that of a surface, explains it: those touch there."""
        facts = self._facts[place]
        if facts.solid and there.judgement(pair).contained:
            return "containment"
        return "approximation" if facts.approximated is not None and there.of_hulls(pair).gap <= allowed else "real"

    def _allowed(self, frame: Frame, pair: Pair, place: int) -> float:
        """m, by how much bodies may be apart, or in each other, without an answer being wrong."""
        known = band_of(self._scene, self._facts[place], self._facts[1 - place], frame, pair)
        return known + _ROUNDING * frame.duration * _fastest(self._scene, frame, pair)


def differing_time(
    question: Question, facts: Facts, scene: Scene, pose: Pose, answer: PairAnswers, other: PairAnswers
) -> Pair | None:
    """The first pair whose time is told another, and once beyond the tolerance, or that only one answer has.

    What touches, within the tolerance, at the start of the frame or at the time that one answer says for the first time
    and no deeper, may be told or not.
    """
    frame, truths = _frame(pose), Truths(scene, pose)
    for pair in sorted(set(answer) | set(other)):
        one, another = both((answer, other), pair)
        allowed = band(scene, facts.allowed, pose, pair)
        if isinf(one) or isinf(another):
            at_end = truths.later(frame.duration).judgement(pair).gap
            if truths.judgement(pair).gap > allowed and at_end < -allowed:
                return pair
        elif abs(one - another) * _fastest(scene, frame, pair) > allowed and any(
            # both may be right: while they graze, bodies are within the tolerance for a long time
            abs(truths.later(time).judgement(pair).gap) > allowed
            for time in (one, another)
        ):
            return pair
    return None


def _fastest(scene: Scene, frame: Frame, pair: Pair) -> float:
    """m/s: no two points of two bodies move faster against each other."""
    bodies = list(pair)
    flying = float(np.linalg.norm(frame.velocities[bodies], axis=1).sum())  # a wall may turn either
    if scene.shape == "sphere":
        return flying
    turning = np.linalg.norm(frame.spins[bodies], axis=1) * scene.enclosing_radii[bodies]
    return flying + float(turning.sum())


def _frame(pose: Pose) -> Frame:
    assert isinstance(pose, Frame), "when bodies begin to touch is asked of frames"
    return pose
