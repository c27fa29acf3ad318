"""The plan of a run: the stages of its pipeline, each kept or left out for a reason.

A pipeline is assembled from its plan, not switched on inside loops. Leaving a stage out never changes an event; where
it would, the stage stays, and an experiment that forces it off (`engine.stages`) is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from harness.errors import InputError, Problem


@dataclass(frozen=True)
class Stage:
    """One stage of a pipeline: kept or left out, and why."""

    name: str
    kept: bool
    why: str


@dataclass(frozen=True)
class Plan:
    """What a run will do, in order, and what its user should be warned of."""

    stages: tuple[Stage, ...]
    warnings: tuple[str, ...] = ()

    def keeps(self, name: str) -> bool:
        """Whether there is a stage of this name, and it is kept."""
        return any(stage.kept for stage in self.stages if stage.name == name)

    @property
    def kept(self) -> frozenset[str]:
        """The names of the stages that are kept."""
        return frozenset(stage.name for stage in self.stages if stage.kept)


class StageError(InputError):
    """Stages that cannot be forced; `refusals` are their names, each with the reason."""

    def __init__(self, refusals: Sequence[tuple[str, str]]) -> None:
        super().__init__([Problem(f"stages: {message}") for _, message in refusals])
        self.refusals = tuple(refusals)


class Decisions:
    """Decides on one stage after another, in the order of the pipeline.

    >>> decisions = Decisions({"hull_axis": False})
    >>> decisions.take("sphere_cull", True, "only close pairs go on")
    True
    >>> decisions.take("hull_axis", True, "hulls decide on close pairs")
    False
    >>> sorted(decisions.finish().kept)
    ['sphere_cull']

    Parameters
    ----------
    forced : stages forced on (True) or off (False), for an ablation
    """

    def __init__(self, forced: Mapping[str, bool] | None = None) -> None:
        self.stages: list[Stage] = []
        self._refusals: list[tuple[str, str]] = []
        self._forced = dict(forced or {})

    def take(self, name: str, kept: bool, why: str, *, fixed: str | None = None) -> bool:
        """Decide on a stage.

        Parameters
        ----------
        name : of the stage
        kept, why : what its scene needs, and the reason
        fixed : what would go wrong the other way; None where forcing it only changes the cost

        Returns
        -------
        bool
            Whether the stage is kept. One that is forced the other way, where that would change an answer, is kept
            as its scene needs it until `finish` or `check` refuses.
        """
        wanted = self._forced.get(name, kept)
        if wanted != kept:
            if fixed is not None:
                self._refusals.append((name, f"{name} cannot be forced {_state(wanted)}: {fixed}"))
                wanted = kept
            else:
                why = f"forced {_state(wanted)} by engine.stages; it would be {'kept' if kept else 'left out'}: {why}"
        self.stages.append(Stage(name, wanted, why))
        return wanted

    def finish(self, warnings: tuple[str, ...] = ()) -> Plan:
        """The plan of all stages that were decided on.

        Raises
        ------
        StageError
            If stages are forced that do not exist, or the other way where that would change an answer: all of them.
        """
        names = [stage.name for stage in self.stages]
        for name in self._forced:
            if name not in names:
                near = get_close_matches(name, names, 1)
                hint = f'did you mean "{near[0]}"?' if near else f"there are {', '.join(names)}"
                self._refusals.append((name, f'this pipeline has no stage "{name}"; {hint}'))
        if self._refusals:
            raise StageError(self._refusals)
        return Plan(tuple(self.stages), warnings)


def span_of(numbers: Sequence[int]) -> str:
    """From the least to the most, in words: one number where they are the same.

    >>> span_of([12]), span_of([12, 1753, 12])
    ('12', '12 to 1753')
    """
    least, most = min(numbers, default=0), max(numbers, default=0)
    return str(least) if least == most else f"{least} to {most}"


def _state(kept: bool) -> str:
    return "on" if kept else "off"
