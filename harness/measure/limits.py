"""The limits that a criterion sets, and how a number or an interval stands to them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

VerdictWord = Literal["holds", "fails", "undecided"]

_SAME = 1e-9  # relative: `equals` allows for rounding


class Within(Protocol):
    """Limits given as a number and a relative distance from it."""

    @property
    def of(self) -> float: ...
    @property
    def relative(self) -> float: ...


class Criterion(Protocol):
    """A row of `expect` or `claims`."""

    @property
    def metric(self) -> str: ...
    @property
    def where(self) -> Mapping[str, Any]: ...
    @property
    def at_most(self) -> float | None: ...
    @property
    def at_least(self) -> float | None: ...
    @property
    def equals(self) -> float | None: ...
    @property
    def between(self) -> tuple[float, float] | None: ...
    @property
    def within(self) -> Within | None: ...
    @property
    def exponent_of(self) -> str | None: ...
    @property
    def ratio_to(self) -> Mapping[str, Any] | None: ...


@dataclass(frozen=True)
class Limits:
    """A closed range, and its words: "at most 2".

    >>> limits = Limits(1.8, 2.2, "between 1.8 and 2.2")
    >>> limits.hold(2.0), limits.judge(1.9, 2.1), limits.judge(1.9, 2.3), limits.judge(2.3, 2.4)
    (True, 'holds', 'undecided', 'fails')
    """

    low: float
    high: float
    text: str

    def hold(self, value: float) -> bool:
        """Whether the value is inside; one that is not a number never is."""
        return self.low <= value <= self.high

    def excess(self, value: float | None) -> float:
        """How far a value lies beyond the nearer limit; negative inside, inf for no value."""
        return math.inf if value is None else max(self.low - value, value - self.high)

    def judge(self, low: float, high: float, rounding: float = 0.0) -> VerdictWord:
        """Whether an interval lies inside, outside, or straddles a limit by more than rounding."""
        if low >= self.low - rounding and high <= self.high + rounding:
            return "holds"
        return "fails" if high < self.low - rounding or low > self.high + rounding else "undecided"


def limits(criterion: Criterion) -> Limits:
    """The limits of the metric, of its exponent or of its ratio."""
    if criterion.within is not None:
        of, part = criterion.within.of, criterion.within.relative
        margin = abs(of) * part
        return Limits(of - margin, of + margin, f"within {declared(100.0 * part)} % of {declared(of)}")
    if criterion.equals is not None:
        margin = abs(criterion.equals) * _SAME
        return Limits(criterion.equals - margin, criterion.equals + margin, f"exactly {declared(criterion.equals)}")
    if criterion.between is not None:
        low, high = criterion.between
        return Limits(low, high, f"between {declared(low)} and {declared(high)}")
    if criterion.at_least is not None:
        return Limits(criterion.at_least, math.inf, f"at least {declared(criterion.at_least)}")
    if criterion.at_most is not None:
        return Limits(-math.inf, criterion.at_most, f"at most {declared(criterion.at_most)}")
    raise ValueError(f"a criterion without limits: {criterion}")


def declared(value: float) -> str:
    """A number as a person wrote it.

    >>> declared(2.0), declared(1e-12)
    ('2', '1e-12')
    """
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e15 else f"{value:.6g}"


def leaves_text(leaves: Mapping[str, Any]) -> str:
    """Leaves and their values as a sentence has them.

    >>> leaves_text({"count": 50, "algorithm": ["grid", "tree"]})
    'count=50, algorithm=grid or tree'
    >>> leaves_text({"query": "collision", "within": None})
    'query=collision, no within'
    """
    return ", ".join(
        f"no {leaf}" if value is None else f"{leaf}={_value_text(value)}" for leaf, value in leaves.items()
    )


def _value_text(value: Any) -> str:
    if isinstance(value, list | tuple):
        return " or ".join(map(_value_text, value))
    if isinstance(value, Mapping):
        return json.dumps(dict(value))
    if isinstance(value, str) and value.startswith('[{"position"'):  # the bodies of a scene, as a table keeps them
        return f"{len(json.loads(value))} given"
    return declared(value) if isinstance(value, int | float) and not isinstance(value, bool) else str(value)
