"""The atlas of correctness: every engine on families of poses, each verdict held against exact arithmetic.

A comparison holds two engines against each other and judges where they differ. Here the judge decides every pose, so
that an error that all engines share counts as well, and rates of wrong verdicts can be told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import betaincinv

from harness.compare.budget import Budget
from harness.compare.certificate import Certificate
from harness.compare.comparison import MOST_FAILURES
from harness.compare.families import family_poses, resting_poses
from harness.compare.isolated import ANSWER_SECONDS, Isolated, UnusableError, preload
from harness.compare.outcome import Case, Failure
from harness.compare.own_gaps import compile_own_gaps
from harness.compare.pair_audit import band
from harness.compare.poses import Pose, PoseSet
from harness.compare.query_answers import make_ready
from harness.compare.tally import NamePair
from harness.compare.truths import Truths
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.vocabulary import OWN, MethodName, Query, Shape

JUDGE = "exact arithmetic"
"""The name under which the judge stands beside an engine."""
_BODIES = (0, 1)
_CONFIDENCE = 0.95
_TIMED = 50
"""Poses of every scene whose queries are timed."""


@dataclass
class AtlasCell:
    """One engine on one family of poses of one shape.

    Parameters
    ----------
    engine, family, shape, mesh : names; mesh is empty for spheres
    verdicts : that were given
    wrong : of those, how many exact arithmetic contradicts; of gaps, those farther off than the numbers can hold
    beyond : of the wrong, how many lie farther from touching than the tolerance that the engine declares; of gaps,
        how many are off by more than that
    deepest : the largest gap or overlap of a wrong verdict, of the size of the smaller body; of gaps, the largest
        error, and of "tolerance" the largest difference of a gap from the one that was asked for; 0 without any
    seconds : CPU time of a query, the median of the sizes and places of the family; 0 where it was not measured
    failures : poses at which it crashed, hung or raised
    query : what was asked: "collision", "tolerance" or "distance"
    """

    engine: str
    family: str
    shape: str
    mesh: str
    verdicts: int = 0
    wrong: int = 0
    beyond: int = 0
    deepest: float = 0.0
    seconds: float = 0.0
    failures: int = 0
    query: Query = "collision"

    @property
    def per_million(self) -> tuple[float, float, float]:
        """Wrong verdicts in a million, and the interval of Clopper and Pearson that holds the rate in 95 %."""
        if not self.verdicts:
            return float("nan"), float("nan"), float("nan")
        wrong, right, tail = self.wrong, self.verdicts - self.wrong, (1.0 - _CONFIDENCE) / 2.0
        low = betaincinv(wrong, right + 1, tail) if wrong else 0.0
        high = betaincinv(wrong + 1, right, 1.0 - tail) if right else 1.0
        return 1e6 * wrong / self.verdicts, 1e6 * float(low), 1e6 * float(high)


@dataclass(frozen=True, eq=False)
class WrongGap:
    """An answer about a gap that is off by more than the engine declares.

    Parameters
    ----------
    scene, pose : where; the hulls of the scene are those that the engine was judged on
    told : m; of "tolerance" 0 for near; inf for bodies that it does not report
    within : m, up to which bodies are near
    gap : m, what is true
    certificate : of the gap
    off, allowed : m, by how much the answer is wrong, and what the engine's tolerance excuses
    """

    scene: Scene
    pose: Pose
    told: float
    within: float
    gap: float
    certificate: Certificate
    off: float
    allowed: float


@dataclass
class Atlas:
    """What was found of every engine.

    Parameters
    ----------
    cells : in the order in which they were asked
    cases : of each cell that has one, the farthest wrong verdict beyond the declared tolerance, by place in `cells`
    gaps : of each cell about gaps that has one, the answer that is farthest off beyond the declared tolerance
    failures : poses at which an engine crashed, hung or raised
    unsupported : what could not be asked, and why
    """

    cells: list[AtlasCell] = field(default_factory=list)
    cases: dict[int, Case] = field(default_factory=dict)
    gaps: dict[int, WrongGap] = field(default_factory=dict)
    failures: list[Failure] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)

    def add(self, other: Atlas) -> None:
        """Take in the atlas of another shape or mesh."""
        before = len(self.cells)
        self.cells += other.cells
        self.cases |= {before + place: case for place, case in other.cases.items()}
        self.gaps |= {before + place: wrong for place, wrong in other.gaps.items()}
        self.failures += other.failures
        self.unsupported += [line for line in other.unsupported if line not in self.unsupported]


def survey(
    shape: Shape,
    mesh: Mesh | None,
    families: Sequence[str],
    count: int,
    names: Sequence[str],
    budget: Budget,
    *,
    progress: Callable[[str], None] = lambda line: None,
    timeout: float = ANSWER_SECONDS,
    asks: type[Survey] | None = None,
    recorded: Scene | None = None,
) -> Atlas:
    """Ask engines about every pose of some families, and judge every answer.

    Parameters
    ----------
    shape, mesh : of the bodies; no mesh for spheres
    families : as in `harness.vocabulary.FAMILIES`
    count : poses of each
    names : engines, or methods of this program
    budget : ends it early, and keeps what was left out
    progress : told what is being done
    timeout : s for an answer
    asks : what asks the engines; whether they touch, if nothing is said
    recorded : whose poses the family "resting" is of
    """
    atlas, asks = Atlas(), asks or Survey
    with budget.paused():
        for name in names:
            preload(name)
            if name == OWN:
                compile_own_gaps(shape)
            else:
                make_ready(MethodName.read(name, shape, asks.query))
    for family in families:
        what = f"{asks.query}, {shape}{f' of {mesh.name}' if mesh is not None and shape != 'sphere' else ''}"
        if budget.spent:
            budget.leave_out(what, family, f"not asked, {budget.why}")
            continue
        progress(f"{what}, {family}: {count} poses")
        if family == "resting" and recorded is not None:
            sets = resting_poses(recorded, count)
        else:
            sets = family_poses(family, shape, (mesh,) if mesh else (), count)
        asked, given = asks(atlas, family, shape, mesh, names, budget, timeout).ask(sets)
        if asked < given:
            budget.leave_out(what, family, f"{given - asked} of {given} poses not asked, {budget.why}")
    return atlas


class Survey:
    """One family put to all engines, asked whether the bodies touch; what asks something else derives from it.

    Attributes
    ----------
    query : what is asked
    """

    query: Query = "collision"

    def __init__(
        self,
        atlas: Atlas,
        family: str,
        shape: Shape,
        mesh: Mesh | None,
        names: Sequence[str],
        budget: Budget,
        timeout: float,
    ) -> None:
        self.atlas, self.family, self.shape, self.mesh = atlas, family, shape, mesh
        self.names, self.budget, self.timeout = names, budget, timeout
        self._places: dict[str, int] = {}
        self._seconds: dict[str, list[float]] = {}

    def ask(self, pose_sets: Iterable[PoseSet]) -> tuple[int, int]:
        """Every engine about every pose, until the time is spent; how many poses that was, and how many there are.

        Poses between every n-th that the budget asks about count as asked.
        """
        given = through = 0
        for pose_set in pose_sets:
            over = self.budget.spent
            if over:
                given += len(pose_set.poses(pose_set.scene))
                continue
            with ExitStack() as processes:
                asked = self._loaded(pose_set.scene, processes)
                # an engine that rounds its hulls is asked about poses of those, and judged by them
                held = {name: replace(pose_set.scene, hulls=one.facts.hulls) for name, one in asked.items()}
                whole = pose_set.poses(pose_set.scene)
                poses = {name: pose_set.poses(held[name]) if one.facts.hulls else whole for name, one in asked.items()}
                answered: list[int] = []
                for place in range(0, len(whole), self.budget.every):
                    if self.budget.spent:
                        break
                    self.ask_at(place, asked, held, poses)
                    answered.append(place)
                else:
                    place = len(whole)
                given, through = given + len(whole), through + place
                for name, one in asked.items():
                    # of the first that were asked: they were all answered, so that none hangs or has to be set up
                    if name not in self._places or self.failures_of(name):
                        continue
                    if (seconds := self.timed(one, [poses[name][place] for place in answered[:_TIMED]])) is not None:
                        self._seconds.setdefault(name, []).append(seconds)
        for name, measured in self._seconds.items():
            self.cell(name).seconds = float(np.median(measured))
        return through, given

    def timed(self, one: Isolated, poses: Sequence[Pose]) -> float | None:
        """CPU time of a query, s."""
        return one.seconds_a_query(poses)

    def _loaded(self, scene: Scene, processes: ExitStack) -> dict[str, Isolated]:
        asked = {}
        for name in self.names:
            try:
                one = processes.enter_context(Isolated(name, scene, self.timeout))
            except UnusableError as error:
                self.say(f"{name} cannot be asked about shape {self.shape}: {error}")
                continue
            if self.query not in one.facts.queries:
                continue
            if one.facts.approximated is not None:
                self.say(f"{one.facts.approximated}; it is judged on hulls")
                continue
            asked[name] = one
        return asked

    def say(self, line: str) -> None:
        """Keep what could not be asked, and why."""
        if line not in self.atlas.unsupported:
            self.atlas.unsupported.append(line)

    def cell(self, name: str) -> AtlasCell:
        """What has been found of an engine in this family."""
        if name not in self._places:
            self._places[name] = len(self.atlas.cells)
            mesh = self.mesh.name if self.mesh is not None and self.shape != "sphere" else ""
            self.atlas.cells.append(AtlasCell(name, self.family, self.shape, mesh, query=self.query))
        return self.atlas.cells[self._places[name]]

    def failures_of(self, name: str) -> int:
        """Poses at which an engine has failed."""
        return self.cell(name).failures if name in self._places else 0

    def ask_at(
        self, place: int, asked: dict[str, Isolated], held: dict[str, Scene], poses: dict[str, Sequence[Pose]]
    ) -> None:
        """Every engine about one pose, which may be another for one that has hulls of its own."""
        shared: Truths | None = None
        right, wrong = [], []
        for name, one in asked.items():
            cell, pose = self.cell(name), poses[name][place]
            if self.failures_of(name) >= MOST_FAILURES:
                continue
            answer = one.pairs(pose)
            if isinstance(answer, str):
                self.failed(cell, pose, place, answer)
                continue
            if one.facts.hulls:
                truths = Truths(held[name], pose)
            else:
                truths = shared = shared or Truths(held[name], pose)
            cell.verdicts += 1
            said = bool(len(answer))
            solid = one.facts.solid and said
            if truths.touch(_BODIES) == said or (solid and truths.judgement(_BODIES).contained):
                right.append(name)
            else:
                wrong.append((name, truths))
        for name, truths in wrong:
            partner = next(iter(right), next((other for other in asked if other != name), JUDGE))
            self._count(name, asked[name], truths, held[name], place, (name, partner))

    def _count(self, name: str, one: Isolated, truths: Truths, scene: Scene, place: int, names: NamePair) -> None:
        """A wrong verdict."""
        cell, truth, sizes = self.cell(name), truths.judgement(_BODIES), scene.bodies.sizes
        gap = abs(truth.gap) / float(sizes.min())
        cell.wrong += 1
        cell.deepest = max(cell.deepest, gap)
        tolerance = one.facts.allowed_on_own_hulls if one.facts.hulls else one.facts.allowed
        if abs(truth.gap) <= band(scene, tolerance, truths.pose, _BODIES):
            return
        cell.beyond += 1
        known = self.atlas.cases.get(self._places[name])
        if known is None or gap > abs(known.judgement.gap) / float(known.scene.bodies.sizes.min()):
            self.atlas.cases[self._places[name]] = Case(
                names, name, _BODIES, truth, scene=scene, pose=truths.pose, query_index=place + 1
            )

    def failed(self, cell: AtlasCell, pose: Pose, place: int, reason: str) -> None:
        """Keep how an engine failed at a pose."""
        cell.failures += 1
        pair = (cell.engine, JUDGE)
        self.atlas.failures.append(Failure(pair, cell.engine, f"{self.family}: {pose.name}", place + 1, reason))
        if cell.failures >= MOST_FAILURES:
            self.say(f"{cell.engine} failed at {MOST_FAILURES} poses of {self.family}; the others are not asked")
