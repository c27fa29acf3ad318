"""The verdicts of two backends on one scene, pose after pose: those that differ are judged, and some of the others too.

What both agree on is put to the judge as well, since both may be wrong: of every fourth hard pose, and as bodies fly of
one pair a frame whose bounding spheres touch (of meshes, whose judgement takes long, every tenth frame).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from harness.backends.close_spheres import close_pairs
from harness.compare.certificate import Judgement
from harness.compare.isolated import Facts
from harness.compare.outcome import Case, Comparison
from harness.compare.poses import Pose
from harness.compare.query_answers import PairAnswers
from harness.compare.question import COLLISION, Question
from harness.compare.tally import Approximation, CheckedAgreement, GapHistogram, NamePair, Tally
from harness.compare.truths import Pair, Truths
from harness.scene.ignored_pairs import without
from harness.scene.scene import Scene

Kind = Literal["undecided", "containment", "approximation", "real"]

KINDS: tuple[Kind, ...] = ("undecided", "containment", "approximation", "real")
"""The worst last."""
_HARD_CHECKED, _MESHES_CHECKED = 4, 10

# A verdict stands on rounded coordinates, whatever the backend: the sum of a position and a vertex, on both sides.
_ROUNDING = 4 * float(np.finfo(float).eps)


class PairAudit:
    """The audit of two backends.

    Parameters
    ----------
    names : of both
    scene : with the hulls that both are held against
    facts : what each declares of itself
    question : whether pairs touch
    flown : whether the bodies fly; else they are put where verdicts are hard

    Attributes
    ----------
    found : what has been found so far
    """

    def __init__(
        self,
        names: NamePair,
        scene: Scene,
        facts: tuple[Facts, Facts],
        question: Question = COLLISION,
        *,
        flown: bool,
    ) -> None:
        self._names, self._scene, self._facts, self._flown = names, scene, facts, flown
        self._tally, self._gaps = Tally(names, scene.shape), GapHistogram(names, scene.shape)
        self._checked = CheckedAgreement(names, scene.shape)
        self._approximation = _approximation(names, scene, facts) if flown else None
        self.found = Comparison(
            tallies=[self._tally],
            checked=[self._checked],
            gaps=[self._gaps],
            approximations=[self._approximation] if self._approximation else [],
        )

    def add(self, truths_there: Truths, query_index: int, answers: tuple[PairAnswers, PairAnswers]) -> None:
        """Count the verdicts of both at a pose; documented as `harness.compare.audit.Audit.add`."""
        pairs = self._scene.pair_count
        first, second = (set(answer) for answer in answers)
        differing = sorted(first ^ second)
        self._tally.poses += 1
        self._tally.verdicts += pairs
        self._tally.agree += pairs - len(differing)
        truths = {pair: self._judge_disagreement(truths_there, query_index, pair, pair in first) for pair in differing}
        if self._approximation is not None:
            reported = first if self._approximation.backend == self._names[0] else second
            _count_approximation(self._approximation, pairs, first & second, reported, truths)
        self._check_agreement(truths_there, query_index, first, second)

    def _judge_disagreement(self, truths: Truths, query_index: int, pair: Pair, first_reports: bool) -> Judgement:
        """Judge a disagreement and count it."""
        truth = truths.judgement(pair)
        wrong = int(first_reports == truth.touching)
        kind = self._kind(truths, pair, wrong)
        setattr(self._tally, kind, getattr(self._tally, kind) + 1)
        self._gaps.count(kind, truth.gap / float(self._scene.bodies.sizes[list(pair)].min()))
        if kind == "real":
            self.found.cases.append(self._case(self._names[wrong], pair, truth, truths.pose, query_index))
        return truth

    def _check_agreement(self, truths: Truths, query_index: int, first: set[Pair], second: set[Pair]) -> None:
        """Judge one of the verdicts that both agree on, at every n-th query."""
        pair = checked_pair(self._scene, truths.pose, query_index, flown=self._flown)
        if pair is None or (pair in first) != (pair in second):
            return
        self._checked.verdicts += 1
        if truths.touch(pair) == (pair in first):
            return
        truth = truths.judgement(pair)
        wrong = [place for place in (0, 1) if self._kind(truths, pair, place) == "real"]
        names = " and ".join(self._names[place] for place in wrong)
        if wrong:
            self._checked.contradicted += 1
            self.found.shared.append(self._case(names, pair, truth, truths.pose, query_index))

    def _case(self, wrong: str, pair: Pair, truth: Judgement, pose: Pose, query_index: int) -> Case:
        return Case(self._names, wrong, pair, truth, scene=self._scene, pose=pose, query_index=query_index)

    def _kind(self, truths: Truths, pair: Pair, wrong: int) -> Kind:
        """What explains that the backend at a place in `names` is wrong; "real" if nothing does."""
        truth = truths.judgement(pair)
        band = band_of(self._scene, self._facts[wrong], self._facts[1 - wrong], truths.pose, pair)
        if abs(truth.gap) <= band:
            return "undecided"
        if truth.contained and self._facts[wrong].solid:
            return "containment"  # of a surface, which the judge alone takes it for
        if self._facts[wrong].approximated is not None:
            # an approximation by the hull may be wrong about the mesh, but must be right about the hull
            hulls = truths.of_hulls(pair)
            if hulls.touching != truth.touching or abs(hulls.gap) <= band:
                return "approximation"
        return "real"


def _approximation(names: NamePair, scene: Scene, facts: tuple[Facts, Facts]) -> Approximation | None:
    """To be counted where one of two replaces the shape, and the other does not."""
    replacing = [place for place in (0, 1) if facts[place].approximated is not None]
    return Approximation(names, scene.shape, names[replacing[0]]) if len(replacing) == 1 else None


def _count_approximation(
    counts: Approximation, pairs: int, agreed: set[Pair], reported: set[Pair], truths: Mapping[Pair, Judgement]
) -> None:
    counts.verdicts += pairs
    counts.reported += len(reported)
    counts.touching += len(agreed) + sum(truth.touching for truth in truths.values())
    false = [truth for pair, truth in truths.items() if pair in reported and not truth.touching]
    counts.false_hits += len(false)
    counts.contained += sum(truth.contained for truth in false)
    counts.misses += sum(truth.touching and pair not in reported for pair, truth in truths.items())


def checked_pair(scene: Scene, pose: Pose, query_index: int, *, flown: bool, within: float = 0.0) -> Pair | None:
    """One of the pairs whose bounding spheres are within a gap (m), another each time; None at most of the queries."""
    every = _HARD_CHECKED if not flown else _MESHES_CHECKED if scene.shape == "mesh" else 1
    return _near_pair(scene, pose, query_index, within) if (query_index - 1) % every == 0 else None


def _near_pair(scene: Scene, pose: Pose, query_index: int, within: float) -> Pair | None:
    near = without(close_pairs(pose.positions, scene.bodies.radii + 0.5 * within), scene.ignored)
    if not len(near):
        return None
    i, j = near[np.random.default_rng(query_index).integers(len(near))].tolist()
    return i, j


def differing_verdict(
    question: Question, facts: Facts, scene: Scene, pose: Pose, answer: PairAnswers, other: PairAnswers
) -> Pair | None:
    """The first pair that only one answer has, and that is farther from touching than the tolerance."""
    truths = Truths(scene, pose)
    for pair in sorted(set(answer) ^ set(other)):
        tolerance = facts.allowed * float(scene.bodies.sizes[list(pair)].max())
        if abs(truths.judgement(pair).gap) > tolerance:
            return pair
    return None


def band_of(scene: Scene, wrong: Facts, other: Facts, pose: Pose, bodies: Pair) -> float:
    """m; on a nearer contact the backend that is wrong need not be right. What the other declares excuses nothing."""
    trusted = bool(wrong.hulls) != bool(other.hulls)
    return band(scene, wrong.allowed_on_own_hulls if trusted and wrong.hulls else wrong.allowed, pose, bodies)


def band(scene: Scene, tolerance: float, pose: Pose, bodies: Pair) -> float:
    """m; on a contact nearer than that a backend of this tolerance (of size) need not be right."""
    chosen = list(bodies)
    largest = float(scene.bodies.sizes[chosen].max())
    farthest = float(np.abs(pose.positions[chosen]).max())
    return tolerance * largest + _ROUNDING * (farthest + largest)
