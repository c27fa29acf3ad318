"""What a metric is: a number that a run reports, and what its kind says of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    from harness.arrays import Floats, Ints, Pairs
    from harness.scene.scene import Scene

Kind = Literal["count", "physics", "error", "cost"]
"""How much was done, what happened in the scene, how wrong it was, and what it took."""

KINDS: tuple[Kind, ...] = ("count", "physics", "error", "cost")
"""The kinds in the order in which metrics are listed and tables show them."""

Better = Literal["less", "more", "neither"]


class Trace(Protocol):
    """The hits of a run and the state that it ended in, as `harness.motion.hits.Trace` has them."""

    @property
    def times(self) -> Floats: ...
    @property
    def bodies(self) -> Pairs: ...
    @property
    def walls(self) -> Ints: ...
    @property
    def time(self) -> float: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def velocities(self) -> Floats: ...
    @property
    def energy(self) -> float: ...


class Outcome(Protocol):
    """What a run came to: its metrics so far, and its trace where its hits were kept."""

    @property
    def metrics(self) -> Mapping[str, float]: ...
    @property
    def trace(self) -> Trace | None: ...


@dataclass(frozen=True)
class Metric:
    """One metric.

    Parameters
    ----------
    name : as runs report it and files name it
    unit : "1" for a plain number
    kind : says which tables show it, and whether less of it is better
    description : what it means, for `harness list`
    title : what pages call it; without, its name in words
    better : which of two values wins. By default less, and neither of what happens in a scene
    noisy : whether two repeats of the same run may differ
    clock : whether it is read from a clock: its repeats are averaged, its controls kept
    exact : whether it is the same on every machine to the last digit, so that another value is another answer
    tabulated : whether the tables of a page have a column of it; else it stands in the CSV file alone
    on_demand : made only where an experiment names it, for it takes a simulation or a measurement of its own
    measure : makes it from the scene and the outcome of a run, once, outside of every clock; None where it has no
        meaning. Without, the motion itself reports it

    Examples
    --------
    >>> passes = Metric("close_passes", "1", "physics", "pairs that came within a tenth of their size")
    >>> passes.heading, passes.ranked
    ('close passes', False)
    """

    name: str
    unit: str
    kind: Kind
    description: str
    title: str = ""
    better: Better | None = None
    noisy: bool = False
    clock: bool = False
    exact: bool = False
    tabulated: bool = True
    on_demand: bool = False
    measure: Callable[[Scene, Outcome], float | None] | None = None

    @property
    def ranked(self) -> bool:
        """Whether one of two values is better."""
        return (self.better or ("neither" if self.kind == "physics" else "less")) != "neither"

    @property
    def more_is_better(self) -> bool:
        """Whether the larger of two values wins."""
        return self.better == "more"

    @property
    def heading(self) -> str:
        """What pages call it."""
        return self.title or self.name.replace("_", " ")


def counter(name: str, description: str, title: str = "", kind: Kind = "count", tabulated: bool = True) -> Metric:
    """A plain number that is exact: it has no noise, and is the same on every machine."""
    return Metric(name, "1", kind, description, title, exact=True, tabulated=tabulated)


def clock(
    name: str,
    meaning: str,
    title: str,
    unit: str = "s",
    better: Better = "less",
    tabulated: bool = True,
    elapsed_tabulated: bool = False,
) -> tuple[Metric, Metric]:
    """CPU time of a phase, or a rate made from it, and the same in elapsed time."""
    return (
        Metric(name, unit, "cost", f"CPU time: {meaning}", title, better, noisy=True, clock=True, tabulated=tabulated),
        Metric(
            f"{name}_elapsed", unit, "cost", f"elapsed time: {meaning}", f"{title}, elapsed", better,
            noisy=True, clock=True, tabulated=elapsed_tabulated,
        ),
    )  # fmt: skip
