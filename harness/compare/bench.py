"""The verdicts of two backends on one scene, pose after pose: those that differ are judged, and some of the others too.

What both agree on is looked at by the judge as well, since both may be wrong: at every fourth hard pose, and as bodies
fly for one pair a frame whose bounding spheres touch (of meshes, whose judgement takes long, every tenth frame).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from harness.arrays import Pairs
from harness.compare.certificate import Judgement
from harness.compare.isolated import Facts
from harness.compare.judge import judge, touches
from harness.compare.outcome import Case, Comparison
from harness.compare.poses import Pose
from harness.compare.tally import Approximation, Backends, Checked, GapAxis, Tally
from harness.scene.scene import Scene

Kind = Literal["undecided", "containment", "approximation", "real"]
Pair = tuple[int, int]

_HARD_CHECKED, _MESHES_CHECKED = 4, 10

# A verdict stands on rounded coordinates, whatever the backend: the sum of a position and a vertex, on both sides.
_ROUNDING = 4 * float(np.finfo(float).eps)


class Bench:
    """Two backends side by side.

    Parameters
    ----------
    names : of both
    scene : with the hulls that both are held against
    facts : what each says of itself
    flown : whether the bodies fly, rather than being put where it is hard

    Attributes
    ----------
    found : what has come of it so far
    """

    def __init__(self, names: Backends, scene: Scene, facts: tuple[Facts, Facts], *, flown: bool) -> None:
        self._names, self._scene, self._facts, self._flown = names, scene, facts, flown
        self._tally, self._gaps = Tally(names, scene.shape), GapAxis(names, scene.shape)
        self._checked = Checked(names, scene.shape)
        self._approximation = _approximation(names, scene, facts) if flown else None
        self.found = Comparison(
            tallies=[self._tally],
            checked=[self._checked],
            gaps=[self._gaps],
            approximations=[self._approximation] if self._approximation else [],
        )

    def take(self, pose: Pose, call: int, answers: Sequence[Pairs]) -> None:
        """Count what both say at a pose."""
        count = len(self._scene.bodies)
        pairs = count * (count - 1) // 2
        said: tuple[set[Pair], set[Pair]] = (_as_set(answers[0]), _as_set(answers[1]))
        differing = sorted(said[0] ^ said[1])
        self._tally.poses += 1
        self._tally.verdicts += pairs
        self._tally.agree += pairs - len(differing)
        truths = {pair: self._differ(pose, call, pair, pair in said[0]) for pair in differing}
        if self._approximation is not None:
            place = self._names.index(self._approximation.backend)
            _count_approximation(self._approximation, pairs, said[0] & said[1], said[place], truths)
        self._check(pose, call, said)

    def _differ(self, pose: Pose, call: int, pair: Pair, first_says: bool) -> Judgement:
        """Judge a disagreement and count it."""
        truth = judge(self._scene, *pair, pose.positions, pose.quaternions)
        wrong = int(first_says == truth.touching)
        kind = self._kind(pose, pair, truth, wrong)
        setattr(self._tally, kind, getattr(self._tally, kind) + 1)
        self._gaps.count(kind, truth.gap / float(self._scene.bodies.sizes[list(pair)].min()))
        if kind == "real":
            self.found.cases.append(Case(self._names, self._names[wrong], pair, truth, self._scene, pose, call))
        return truth

    def _check(self, pose: Pose, call: int, said: tuple[set[Pair], set[Pair]]) -> None:
        """Judge one of the verdicts that both agree on, if it is this call's turn."""
        every = _HARD_CHECKED if not self._flown else _MESHES_CHECKED if self._scene.shape == "mesh" else 1
        pair = _near_pair(self._scene, pose, call) if (call - 1) % every == 0 else None
        if pair is None or (pair in said[0]) != (pair in said[1]):
            return
        self._checked.verdicts += 1
        if touches(self._scene, *pair, pose.positions, pose.quaternions) == (pair in said[0]):
            return
        truth = judge(self._scene, *pair, pose.positions, pose.quaternions)
        wrong = [place for place in (0, 1) if self._kind(pose, pair, truth, place) == "real"]
        names = " and ".join(self._names[place] for place in wrong)
        if wrong:
            self._checked.contradicted += 1
            self.found.shared.append(Case(self._names, names, pair, truth, self._scene, pose, call))

    def _kind(self, pose: Pose, pair: Pair, truth: Judgement, wrong: int) -> Kind:
        """Whether the backend that is wrong could help it."""
        band = _band(self._scene, self._facts, pose, pair)
        if abs(truth.gap) <= band:
            return "undecided"
        if truth.contained:
            return "containment"
        if self._facts[wrong].approximated is not None:
            # an approximation by the hull may be wrong about the mesh, but must be right about the hull
            hulls = judge(replace(self._scene, shape="hull"), *pair, pose.positions, pose.quaternions)
            if hulls.touching != truth.touching or abs(hulls.gap) <= band:
                return "approximation"
        return "real"


def _approximation(names: Backends, scene: Scene, facts: tuple[Facts, Facts]) -> Approximation | None:
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


def _near_pair(scene: Scene, pose: Pose, call: int) -> Pair | None:
    """One of the pairs whose bounding spheres touch, another each time."""
    radii = scene.bodies.radii
    pairs = cKDTree(pose.positions).query_pairs(2 * float(radii.max()), output_type="ndarray")
    apart = np.linalg.norm(pose.positions[pairs[:, 0]] - pose.positions[pairs[:, 1]], axis=1)
    near = pairs[apart <= radii[pairs].sum(axis=1)]
    if not len(near):
        return None
    ordered = near[np.lexsort((near[:, 1], near[:, 0]))]
    i, j = ordered[np.random.default_rng(call).integers(len(ordered))].tolist()
    return i, j


def _as_set(pairs: Pairs) -> set[Pair]:
    return {(i, j) for i, j in pairs.tolist()}


def _band(scene: Scene, facts: tuple[Facts, Facts], pose: Pose, bodies: tuple[int, int]) -> float:
    """m; of a nearer contact the two backends need not agree."""
    holding = [bool(one.hulls) for one in facts]
    trusted = sum(holding) == 1
    tolerance = max(
        one.hulls_tolerance if trusted and holds else one.tolerance for one, holds in zip(facts, holding, strict=True)
    )
    chosen = list(bodies)
    largest = float(scene.bodies.sizes[chosen].max())
    return tolerance * largest + _ROUNDING * (float(np.abs(pose.positions[chosen]).max()) + largest)
