"""When two methods say that pairs begin to touch in a frame: where they differ, exact verdicts at instants decide.

A method that says a time is wrong if the bodies are proven to be apart at that time, by more than its tolerance: it is
early, or the hit is none. A method that says a later time, or none, is wrong if they are proven to be apart at the
start of the frame and, at an instant before the time that it says, to be in each other deeper than its tolerance: it is
late, or the hit is missed. So each accusation is a proof or two, and no search for the true time is believed.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, isinf
from typing import NamedTuple

import numpy as np

from harness.compare.certificate import Judgement
from harness.compare.isolated import Facts
from harness.compare.outcome import Case, Comparison
from harness.compare.pair_audit import KINDS, Kind, band, band_of, checked_pair
from harness.compare.poses import Frame, Pose
from harness.compare.query_answers import Told
from harness.compare.question import Question
from harness.compare.tally import CheckedAgreement, NamePair, Tally
from harness.compare.truths import Pair, Truths
from harness.scene.scene import Scene

# Instants between two times that are looked at for a proof that bodies touch: each halves what is left to the first.
_HALVINGS = 24
# Of the way of the fastest points: what a time, and the places at it, are rounded by.
_ROUNDING = 1e-12


class _Wrong(NamedTuple):
    """What is held against an answer, and what explains it; "real" if nothing does.

    Attributes
    ----------
    truth : that the bodies are apart, or touch
    moment : s after the start of the frame, when that is so
    """

    kind: Kind
    truth: Judgement
    moment: float


class ImpactAudit:
    """The audit of two methods asked "impact"; documented as `harness.compare.audit.Audit`.

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
        differing = [pair for pair, times in told.items() if self._differ(truths.pose, pair, times)]
        self._tally.poses += 1
        self._tally.verdicts += pairs
        self._tally.agree += pairs - len(differing)
        for pair in differing:
            times = told[pair]
            against = [self._against(truths, pair, place, times[place], times[1 - place]) for place in (0, 1)]
            kinds: list[Kind] = [one.kind if one else "undecided" for one in against]
            kind = max(kinds, key=KINDS.index)
            setattr(self._tally, kind, getattr(self._tally, kind) + 1)
            for place, one in enumerate(against):
                if one is not None and one.kind == "real":
                    self.found.cases.append(self._case(place, pair, times[place], one, truths.pose, query_index))
        self._check_agreement(truths, query_index, answers, differing)

    def _check_agreement(
        self, truths: Truths, query_index: int, answers: tuple[Told, Told], differing: list[Pair]
    ) -> None:
        """Judge one of the answers that both agree on, at every n-th query."""
        frame = _frame(truths.pose)
        way = 2.0 * frame.duration * float(np.linalg.norm(frame.velocities, axis=1).max(initial=0.0))
        pair = checked_pair(self._scene, frame, query_index, flown=self._flown, within=way)
        if pair is None or pair in differing:
            return
        self._checked.verdicts += 1
        told = _both(answers, pair)
        # of what neither reports it is asked whether they are in each other at the end
        against = [self._against(truths, pair, place, told[place], frame.duration) for place in (0, 1)]
        wrong = [place for place, one in enumerate(against) if one is not None and one.kind == "real"]
        if wrong:
            self._checked.contradicted += 1
            one = against[wrong[0]]
            assert one is not None
            case = self._case(wrong[0], pair, told[wrong[0]], one, frame, query_index)
            names = " and ".join(self._names[place] for place in wrong)
            self.found.shared.append(replace(case, wrong=names))

    def _differ(self, pose: Pose, pair: Pair, times: tuple[float, float]) -> bool:
        if isinf(times[0]) or isinf(times[1]):
            return isinf(times[0]) != isinf(times[1])
        allowed = max(band(self._scene, facts.tolerance, pose, pair) for facts in self._facts)
        return abs(times[0] - times[1]) * _fastest(self._scene, _frame(pose), pair) > allowed

    def _against(self, truths: Truths, pair: Pair, place: int, time: float, other: float) -> _Wrong | None:
        """What is proven against an answer, with the help of the other's time; None if nothing is."""
        frame = _frame(truths.pose)
        allowed = self._allowed(frame, pair, place)
        if not isinf(time):
            there = truths.later(time)
            truth = there.judgement(pair)
            if truth.gap > allowed:
                return _Wrong(self._explained(there, pair, place, allowed), truth, time)
        if other >= time or truths.judgement(pair).gap <= allowed:
            return None  # nothing is said of what touches at the start, until it has parted
        last = min(time, frame.duration)
        instants = (other + (last - other) * 0.5**power for power in range(_HALVINGS + 1))
        for instant in instants if other < last else (last,):
            truth = truths.later(instant).judgement(pair)
            if truth.touching and truth.gap < -allowed:
                return _Wrong(self._explained(truths, pair, place, allowed), truth, instant)
        return None

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

    def _case(self, place: int, pair: Pair, told: float, one: _Wrong, pose: Pose, query_index: int) -> Case:
        return Case(
            self._names,
            self._names[place],
            pair,
            one.truth,
            scene=self._scene,
            pose=pose,
            query_index=query_index,
            question=self._question,
            told=told,
            moment=one.moment,
        )


def differing_time(
    question: Question, facts: Facts, scene: Scene, pose: Pose, answer: Told, other: Told
) -> Pair | None:
    """The first pair whose time is told another by more than the tolerance, or that only one answer has.

    What touches, within the tolerance, at the start of the frame or at the time that one answer says for the first time
    and no deeper, may be told or not.
    """
    frame, truths = _frame(pose), Truths(scene, pose)
    for pair in sorted(set(answer) | set(other)):
        one, another = _both((answer, other), pair)
        allowed = band(scene, facts.tolerance, pose, pair)
        if isinf(one) or isinf(another):
            at_end = truths.later(frame.duration).judgement(pair).gap
            if truths.judgement(pair).gap > allowed and at_end < -allowed:
                return pair
        elif abs(one - another) * _fastest(scene, frame, pair) > allowed:
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


def _both(answers: tuple[Told, Told], pair: Pair) -> tuple[float, float]:
    return answers[0].get(pair, inf), answers[1].get(pair, inf)
