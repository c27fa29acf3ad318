"""The atlas of gaps: how far apart engines say that two bodies are, and whether they are near, held against the truth.

The truth is the exact distance with its certificate. Whether bodies are near is asked with a limit that differs from
their gap by 0 or 1e-15 … 1e-2 of a size, so that this is as hard to tell as whether grazing bodies touch.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isinf
from typing import Any

import numpy as np

from harness.compare.atlas import Survey, WrongGap
from harness.compare.comparison import MOST_FAILURES
from harness.compare.exact_gap import ExactGap
from harness.compare.isolated import Isolated, NearQuestion
from harness.compare.judge import judge
from harness.compare.pair_audit import band
from harness.compare.poses import Pose
from harness.scene.scene import Scene
from harness.vocabulary import Query

_SEED = 259
_BODIES = (0, 1)
# What a backend raises that has the shape, but no gaps of it.
_UNABLE = "InputError: "
# Of the sum of the sizes: no bodies of any family are farther apart.
_FAR = 1.0


class GapSurvey(Survey):
    """One family put to all engines, which are asked how far apart the bodies are."""

    query: Query = "distance"
    exact = 1.0  # of what the numbers can hold: by how much an answer must be off to be wrong
    limit = 0.0  # m, up to which bodies count as near, at the newest pose

    def __init__(self, *asked: Any) -> None:
        super().__init__(*asked)
        self._unable: set[str] = set()

    def timed(self, one: Isolated, poses: Sequence[Pose]) -> float | None:
        if not poses:
            return None
        return one.seconds_a_query(poses, NearQuestion(self.query, poses[0], self.limit))

    def ask_at(
        self, place: int, asked: dict[str, Isolated], held: dict[str, Scene], poses: dict[str, Sequence[Pose]]
    ) -> None:
        shared: ExactGap | None = None
        for name, one in asked.items():
            scene, pose = held[name], poses[name][place]
            if name in self._unable or self.failures_of(name) >= MOST_FAILURES:
                continue
            truth = ExactGap(scene, pose) if shared is None or one.facts.hulls else shared
            shared = shared if one.facts.hulls else truth
            self.limit = self.limit_of(scene, truth, place)
            told = one.near(NearQuestion(self.query, pose, self.limit))
            if isinstance(told, str) and told.startswith(_UNABLE):
                self.say(f"{name} cannot be asked about {self.query}, {self.shape}: {told.removeprefix(_UNABLE)}")
                self._unable.add(name)
                continue
            cell = self.cell(name)
            if isinstance(told, str):
                self.failed(cell, pose, place, told)
                continue
            error = self.error(truth, told)
            if error is None:
                continue
            cell.verdicts += 1
            if not error > band(scene, 0.0, pose, _BODIES) * self.exact or (
                told == 0.0 and one.facts.solid and judge(scene, *_BODIES, pose.positions, pose.quaternions).contained
            ):
                continue
            truth.check()  # before an engine is accused
            cell.wrong += 1
            cell.deepest = max(cell.deepest, float(error) / float(scene.bodies.sizes.min()))
            tolerance = one.facts.allowed_on_own_hulls if one.facts.hulls else one.facts.allowed
            allowed = band(scene, tolerance, pose, _BODIES)
            if error > allowed:
                cell.beyond += 1
                self._accuse(
                    name, WrongGap(scene, pose, told, self.limit, truth.value, truth.certificate, error, allowed)
                )

    def _accuse(self, name: str, wrong: WrongGap) -> None:
        """Keep the answer that is farthest off, of the size of the smaller body."""
        known = self.atlas.gaps.get(self._places[name])
        if known is None or _off(wrong) > _off(known):
            self.atlas.gaps[self._places[name]] = wrong

    def limit_of(self, scene: Scene, truth: ExactGap, place: int) -> float:
        """m, up to which bodies count as near."""
        return _FAR * float(scene.bodies.sizes.sum())

    def error(self, truth: ExactGap, told: float) -> float | None:
        """m, by how much an answer is off; None where the truth is not decided."""
        return self.limit - truth.value if isinf(told) else truth.off_by(told)


class NearSurvey(GapSurvey):
    """One family put to all engines, which are asked whether the bodies are nearer than a length."""

    query: Query = "tolerance"
    exact = 0.0

    def limit_of(self, scene: Scene, truth: ExactGap, place: int) -> float:
        rng = np.random.default_rng((_SEED, place))
        step = float(rng.choice([-1.0, 1.0]) * 10.0 ** int(rng.integers(-15, -1))) if rng.random() < 0.95 else 0.0
        return abs(truth.value + step * float(scene.bodies.sizes.min()))

    def error(self, truth: ExactGap, told: float) -> float | None:
        near = truth.at_most(self.limit)
        if near is None:
            return None
        return 0.0 if near == (not isinf(told)) else max(abs(truth.value - self.limit), np.finfo(float).tiny)


def _off(wrong: WrongGap) -> float:
    return wrong.off / float(wrong.scene.bodies.sizes.min())


SURVEYS: dict[Query, type[Survey]] = {"collision": Survey, "tolerance": NearSurvey, "distance": GapSurvey}
"""What asks a query of all engines."""
