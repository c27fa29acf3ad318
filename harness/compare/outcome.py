"""What a comparison has found: counts, and every wrong verdict with its proof."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isinf

from harness.compare.certificate import Judgement
from harness.compare.free_run_pair import FreeRunPair
from harness.compare.poses import Pose
from harness.compare.question import COLLISION, Question
from harness.compare.tally import Approximation, CheckedAgreement, GapHistogram, NamePair, Tally, merge
from harness.scene.scene import Scene


@dataclass(frozen=True, eq=False)
class Case:
    """A wrong verdict.

    Parameters
    ----------
    backends : both names
    wrong : the one that the judge contradicts; both names, where both agree on what is wrong
    bodies : i < j
    judgement : what is true, with the proof
    scene, pose : where; the hulls of the scene are those both backends were held against
    query_index : which query of this scene it was, from 1
    question : what was asked
    told : what it said: a gap (m), or seconds after the start of the frame; inf where it does not report the pair. None
        where it was asked for no number
    moment : s after the start of the frame, of the judgement; 0 where poses do not move
    """

    backends: NamePair
    wrong: str
    bodies: tuple[int, int]
    judgement: Judgement
    scene: Scene
    pose: Pose
    query_index: int
    question: Question = COLLISION
    told: float | None = None
    moment: float = 0.0

    @property
    def both_wrong(self) -> bool:
        """Whether both agree on what is wrong."""
        return self.wrong not in self.backends

    @property
    def error(self) -> str:
        """In which way an answer to a query other than collision is wrong; empty for collision.

        "missed" of a pair that is not reported, "false" of one that is not near, "too wide" or "too narrow" of a gap,
        "late" or "early" of a time; a hit that is none is called early.
        """
        if self.told is None:
            return ""
        if isinf(self.told):
            return "missed"
        if self.question.query == "impact":
            return "late" if self.judgement.touching else "early"
        if self.question.query == "tolerance":
            return "false"
        return "too wide" if self.told > self.judgement.gap else "too narrow"


LOADING = "loading"
"""In the place of the name of a pose: as the backend was given the scene."""


TIMED = "timed runs"
"""In the place of the name of a pose: in the runs of a sweep, which were timed before."""


POINTS = "nearest points"
"""The kind of a failure: points that are given with a gap, and are none of the bodies or not so far apart."""


@dataclass(frozen=True)
class Failure:
    """A backend that crashed, hung or raised at a pose, or cannot be held to what it says; `query_index` as in `Case`.

    Parameters
    ----------
    pose : its name, or `LOADING`, or `TIMED`
    kind : "crashed"; "random" or "depends on order" for a verdict that changes; "claim" for what it says of itself;
        "otherwise when timed" for runs that do not answer as it answers here; or `POINTS`
    bodies : of the pair whose verdict changes
    """

    backends: NamePair
    backend: str
    pose: str
    query_index: int
    reason: str
    kind: str = "crashed"
    bodies: tuple[int, ...] = ()

    @property
    def sentence(self) -> str:
        """For people, without a full stop.

        >>> Failure(("a", "b"), "a", LOADING, 0, "it declares a tolerance of 2 of a size", kind="claim").sentence
        'a is wrong: it declares a tolerance of 2 of a size'
        """
        where = "before it was asked anything" if self.pose == LOADING else f"at {self.pose} (call {self.query_index})"
        if self.kind in ("claim", "otherwise when timed"):
            return f"{self.backend} is wrong: {self.reason}"
        return f"{self.backend} {'failed' if self.kind == 'crashed' else 'is wrong'} {where}: {self.reason}"


@dataclass
class Comparison:
    """Everything a comparison has found.

    Parameters
    ----------
    tallies, approximations, checked, gaps : counts, each of a pair of backends on a shape
    cases : real disagreements
    shared : verdicts that both backends agree on and that the judge contradicts; `wrong` names both
    failures : poses at which a backend crashed, hung or raised
    unsupported : which pairs could not be compared, and why
    left_out : what was not asked, because the time for it was spent
    free_runs : pairs of runs, each by the hits of its own backend
    """

    tallies: list[Tally] = field(default_factory=list)
    approximations: list[Approximation] = field(default_factory=list)
    checked: list[CheckedAgreement] = field(default_factory=list)
    gaps: list[GapHistogram] = field(default_factory=list)
    cases: list[Case] = field(default_factory=list)
    shared: list[Case] = field(default_factory=list)
    failures: list[Failure] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    free_runs: list[FreeRunPair] = field(default_factory=list)

    def add(self, other: Comparison) -> None:
        """Take in another one; verdicts of the same backends on the same shape are counted together."""
        merge(self.tallies, other.tallies)
        merge(self.approximations, other.approximations)
        merge(self.checked, other.checked)
        merge(self.gaps, other.gaps)
        self.cases += other.cases
        self.shared += other.shared
        # what fails to load fails so at every scene
        self.failures += [one for one in other.failures if one.pose != LOADING or one not in self.failures]
        self.free_runs += other.free_runs
        self.left_out += [line for line in other.left_out if line not in self.left_out]
        self.unsupported += [line for line in other.unsupported if line not in self.unsupported]

    @property
    def passed(self) -> bool:
        """Whether there is no disagreement outside the tolerance, no error that both share, and no failure."""
        return not self.cases and not self.shared and not self.failures
