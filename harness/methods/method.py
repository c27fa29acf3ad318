"""What a method is: it makes the plan of a run, and the plan that it makes is what it loads and flies.

A new method is a file in this folder, named as its algorithm is, with a class of this form called `METHOD`; its word is
a line in `harness.vocabulary`. A new broad phase needs none: it is flown by `harness.methods.culled`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from typing import ClassVar, Protocol

from harness.methods.stages import Plan
from harness.motion.hits import Outcome
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Shape

WarmUp = tuple[str, Callable[[], None]]
"""Kernels that belong together, by a name that stands for them once a process, and what compiles them."""


class Pipeline(Protocol):
    """A loaded plan: what the plan keeps, assembled; nothing that it leaves out is there to be asked."""

    def fly(self, law: MotionLaw, *, traced: bool = False, observed: bool = True) -> Outcome:
        """Fly the scene once, from its start.

        Parameters
        ----------
        law : MotionLaw
            Of the response that the plan was made for, and no longer than that.
        traced : keep every hit
        observed : count and measure what is outside of the clocks; else the outcome has clocks alone
        """


class Method(ABC):
    """What answers a run's question.

    Parameters
    ----------
    name : MethodName
    tolerance : of size; when two surfaces count as touching, and how well gaps are known, for methods that have such a
        knob
    within : m, the gap up to which pairs are asked about, for the queries that have one
    forced : stages forced on (True) or off (False) for an ablation
    threads : that share out the pairs of a frame, of an algorithm that can be shared
    """

    shapes: ClassVar[tuple[Shape, ...]] = ("sphere", "hull", "mesh")

    def __init__(
        self,
        name: MethodName,
        *,
        tolerance: float = 1e-6,
        within: float | None = None,
        forced: Mapping[str, bool] | None = None,
        threads: int = 1,
    ) -> None:
        self.name = name
        self.threads = threads
        self.tolerance = tolerance
        self.within = within
        self.forced = dict(forced or {})

    @abstractmethod
    def plan(self, scene: Scene, law: MotionLaw, *, recorded: bool = False) -> Plan:
        """Which stages a run needs, which it does not, and why.

        Parameters
        ----------
        scene : Scene
        law : MotionLaw
        recorded : whether the course of every body is to be kept for a replay; the clocks of such a run see it

        Raises
        ------
        StageError
            If a forced stage does not exist, or forcing it would change the result.
        InputError
            If the method needs a library that is missing.
        """

    @abstractmethod
    def load(self, scene: Scene, plan: Plan) -> Pipeline:
        """Assemble what the plan keeps.

        Raises
        ------
        InputError
            If the method cannot hold the scene.
        """

    @abstractmethod
    def warm_ups(self, meshes: int = 1) -> Iterator[WarmUp]:
        """What to compile before a run, so that no clock sees it.

        Parameters
        ----------
        meshes : how many the scene has: kernels over bodies of one mesh are others than over those of several
        """
