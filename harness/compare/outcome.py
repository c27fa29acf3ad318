"""What a comparison has found: counts, and every case in which somebody is wrong, with the proof."""

from __future__ import annotations

from dataclasses import dataclass, field

from harness.compare.certificate import Judgement
from harness.compare.poses import Pose
from harness.compare.side_by_side import SideBySide
from harness.compare.tally import Approximation, Backends, Checked, GapAxis, Tally, together
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
    call : the how-manieth question of this scene it was, from 1
    """

    backends: Backends
    wrong: str
    bodies: tuple[int, int]
    judgement: Judgement
    scene: Scene
    pose: Pose
    call: int


@dataclass(frozen=True)
class Failure:
    """A backend that crashed, hung or raised at a pose."""

    backends: Backends
    backend: str
    pose: str
    call: int
    reason: str


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
    flights : what came of bodies that both flew, each by its own hits
    """

    tallies: list[Tally] = field(default_factory=list)
    approximations: list[Approximation] = field(default_factory=list)
    checked: list[Checked] = field(default_factory=list)
    gaps: list[GapAxis] = field(default_factory=list)
    cases: list[Case] = field(default_factory=list)
    shared: list[Case] = field(default_factory=list)
    failures: list[Failure] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)
    flights: list[SideBySide] = field(default_factory=list)

    def add(self, other: Comparison) -> None:
        """Take in another one; verdicts of the same backends on the same shape are counted together."""
        together(self.tallies, other.tallies)
        together(self.approximations, other.approximations)
        together(self.checked, other.checked)
        together(self.gaps, other.gaps)
        self.cases += other.cases
        self.shared += other.shared
        self.failures += other.failures
        self.flights += other.flights
        self.unsupported += [line for line in other.unsupported if line not in self.unsupported]

    @property
    def passed(self) -> bool:
        """Whether nobody was wrong beyond help, and nobody failed."""
        return not self.cases and not self.shared and not self.failures
