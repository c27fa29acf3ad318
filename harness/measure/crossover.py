"""From which x on one method costs less than another.

Costs between two measured x are not known: a straight line between them on logarithmic axes misses the crossing of
curved costs by more than any noise. So a crossing is given by the two measured x that it lies between, at each of which
the costs are told apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Leader = Literal["a", "b", ""]
"""Which of two methods, a and b, costs less; "" where that cannot be told."""


@dataclass(frozen=True)
class Crossover:
    """Where the costs of two methods, a and b, cross for the last time as x grows.

    Parameters
    ----------
    ahead : the method that costs less from `by` on, at every larger x that was measured
    by : the smallest such x
    after : the largest x at which the other costs less; None where that is nowhere told
    everywhere : whether the one ahead costs less at every x
    """

    ahead: Leader
    by: float
    after: float | None
    everywhere: bool


def crossover(leaders: Mapping[float, Leader]) -> Crossover | None:
    """The crossover of two methods.

    Parameters
    ----------
    leaders : {x: which of the two costs less there}

    Returns
    -------
    Crossover or None
        None below two x, and where nobody is ahead at the largest.

    Examples
    --------
    >>> crossover({10: "a", 20: "a", 40: "", 80: "b", 160: "b"})
    Crossover(ahead='b', by=80, after=20, everywhere=False)
    >>> crossover({10: "b", 20: "b"}).everywhere, crossover({10: "a", 20: ""})
    (True, None)
    """
    xs = sorted(leaders)
    if len(xs) < 2 or not leaders[xs[-1]]:
        return None
    ahead = leaders[xs[-1]]
    others = [x for x in xs if leaders[x] != ahead]
    by = next(x for x in xs if not others or x > others[-1])
    opposed = [x for x in others if leaders[x]]
    return Crossover(ahead, by, opposed[-1] if opposed else None, not others)
