"""Two backends at the same poses: where their verdicts differ, whose is wrong, and whether it could be helped."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, fields, replace
from itertools import combinations
from typing import Literal

import numpy as np

from harness.arrays import Pairs
from harness.compare.certificate import Judgement
from harness.compare.isolated import PATIENCE, Facts, Isolated, UnusableError
from harness.compare.judge import judge
from harness.compare.poses import Pose, PoseSet
from harness.scene.scene import Scene, Shape

Kind = Literal["undecided", "containment", "approximation", "real"]

MOST_FAILURES = 5
"""A backend that has crashed or hung so often at the poses of one scene is not asked about the rest of them."""

# A verdict stands on rounded coordinates, whatever the backend: the sum of a position and a vertex, on both sides.
_ROUNDING = 4 * float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Case:
    """A real disagreement.

    Parameters
    ----------
    backends : both names
    wrong : the one that the judge contradicts
    bodies : i < j
    judgement : what is true, with the proof
    scene, pose : where; the hulls of the scene are those both backends were held against
    call : the how-manieth question of this scene it was, from 1
    """

    backends: tuple[str, str]
    wrong: str
    bodies: tuple[int, int]
    judgement: Judgement
    scene: Scene
    pose: Pose
    call: int


@dataclass(frozen=True)
class Failure:
    """A backend that crashed, hung or raised at a pose."""

    backends: tuple[str, str]
    backend: str
    pose: str
    call: int
    reason: str


@dataclass
class Tally:
    """What came of the verdicts of one pair of backends on one shape.

    `verdicts` is the sum of `agree` and of all kinds of disagreement; poses at which a backend failed have none.
    """

    backends: tuple[str, str]
    shape: Shape
    poses: int = 0
    verdicts: int = 0
    agree: int = 0
    undecided: int = 0
    containment: int = 0
    approximation: int = 0
    real: int = 0


@dataclass
class Comparison:
    """Everything a comparison has found. `unsupported` says which pairs could not be compared, and why."""

    tallies: list[Tally] = field(default_factory=list)
    cases: list[Case] = field(default_factory=list)
    failures: list[Failure] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)

    def add(self, other: Comparison) -> None:
        """Take in another one; verdicts of the same backends on the same shape are counted together."""
        for tally in other.tallies:
            same = next((t for t in self.tallies if (t.backends, t.shape) == (tally.backends, tally.shape)), None)
            if same is None:
                self.tallies.append(replace(tally))
                continue
            for count in fields(Tally)[2:]:
                setattr(same, count.name, getattr(same, count.name) + getattr(tally, count.name))
        self.cases += other.cases
        self.failures += other.failures
        self.unsupported += [line for line in other.unsupported if line not in self.unsupported]

    @property
    def passed(self) -> bool:
        """Whether nobody was wrong beyond help, and nobody failed."""
        return not self.cases and not self.failures


def compare(
    settings: Iterable[PoseSet],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda line: None,
    patience: float = PATIENCE,
) -> Comparison:
    """Hold every two of some backends against each other.

    Parameters
    ----------
    settings : the scenes and the poses to ask about
    names : of two backends at least
    progress : told what is being done
    patience : s for an answer at one pose
    """
    found = Comparison()
    tallies: dict[tuple[tuple[str, str], Shape], Tally] = {}
    for setting in settings:
        for first, second in combinations(names, 2):
            both, shape = (first, second), setting.scene.shape
            tally = tallies.setdefault((both, shape), Tally(both, shape))
            progress(f"{first} and {second}: {len(setting.scene.bodies)} bodies, shape {shape}")
            try:
                _compare_two(setting, tally, found, patience)
            except UnusableError as error:
                line = f"{first} and {second} are not comparable on shape {shape}: {error}"
                if line not in found.unsupported:
                    found.unsupported.append(line)
    found.tallies += tallies.values()
    return found


def disagreements(scene: Scene, pose: Pose, names: tuple[str, str]) -> list[Case]:
    """The real disagreements of two backends at one pose, each asked once, afresh.

    Raises
    ------
    UnusableError
    """
    found = Comparison()
    _compare_two(PoseSet(scene, lambda held: (pose,)), Tally(names, scene.shape), found, PATIENCE)
    return found.cases


def _compare_two(setting: PoseSet, tally: Tally, found: Comparison, patience: float) -> None:
    with ExitStack() as processes:
        scene, asked = _loaded(setting.scene, tally.backends, processes, patience)
        facts = (asked[0].facts, asked[1].facts)
        failures = [0, 0]
        for call, pose in enumerate(setting.poses(scene), 1):
            answers: list[Pairs] = []
            for place, backend in enumerate(asked):
                answer = backend.pairs(pose)
                if isinstance(answer, str):
                    failures[place] += 1
                    found.failures.append(Failure(tally.backends, tally.backends[place], pose.name, call, answer))
                else:
                    answers.append(answer)
            if max(failures) >= MOST_FAILURES:
                tired = tally.backends[int(failures[1] > failures[0])]
                found.unsupported.append(
                    f"{tired} failed at {MOST_FAILURES} poses; from {pose.name} on it is not asked"
                )
                return
            if len(answers) == 2:
                _count(tally, scene, facts, pose, call, answers, found)


def _loaded(
    scene: Scene, names: tuple[str, str], processes: ExitStack, patience: float
) -> tuple[Scene, list[Isolated]]:
    """Both backends with the scene; where one of them holds hulls of its own, the other is given those."""
    asked = [_enter(name, scene, processes, patience) for name in names]
    holders = [place for place in (0, 1) if asked[place].facts.hulls]
    if len(holders) == 1:
        other = 1 - holders[0]
        scene = replace(scene, hulls=asked[holders[0]].facts.hulls)
        asked[other] = _enter(names[other], scene, processes, patience)
    return scene, asked


def _enter(name: str, scene: Scene, processes: ExitStack, patience: float) -> Isolated:
    try:
        return processes.enter_context(Isolated(name, scene, patience))
    except UnusableError as error:
        raise UnusableError(f"{name}: {error}") from None


def _count(
    tally: Tally,
    scene: Scene,
    facts: tuple[Facts, Facts],
    pose: Pose,
    call: int,
    answers: Sequence[Pairs],
    found: Comparison,
) -> None:
    """Add the verdicts at one pose to the tally, and the real disagreements to the cases."""
    bodies = len(scene.bodies)
    sets = [set(map(tuple, answer.tolist())) for answer in answers]
    tally.poses += 1
    tally.verdicts += bodies * (bodies - 1) // 2
    differing = sorted(sets[0] ^ sets[1])
    tally.agree += bodies * (bodies - 1) // 2 - len(differing)
    for i, j in differing:
        truth = judge(scene, i, j, pose.positions, pose.quaternions)
        wrong = int(((i, j) in sets[0]) == truth.touching)
        kind = _kind(scene, facts, pose, (i, j), truth, wrong)
        setattr(tally, kind, getattr(tally, kind) + 1)
        if kind == "real":
            found.cases.append(Case(tally.backends, tally.backends[wrong], (i, j), truth, scene, pose, call))


def _kind(
    scene: Scene, facts: tuple[Facts, Facts], pose: Pose, bodies: tuple[int, int], truth: Judgement, wrong: int
) -> Kind:
    band = _band(scene, facts, pose, bodies)
    if abs(truth.gap) <= band:
        return "undecided"
    if truth.contained:
        return "containment"
    if facts[wrong].approximated is not None:
        # an approximation by the hull may be wrong about the mesh, but must be right about the hull
        hulls = judge(replace(scene, shape="hull"), *bodies, pose.positions, pose.quaternions)
        if hulls.touching != truth.touching or abs(hulls.gap) <= band:
            return "approximation"
    return "real"


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
