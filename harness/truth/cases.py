"""The cases of a set: pairs of bodies, how they move, and what is claimed of when they begin to touch."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats, Ints
from harness.truth.flights import Flights, stacked

Words: TypeAlias = NDArray[np.str_]


class Cases(NamedTuple):
    """n cases.

    Attributes
    ----------
    families : (n,) text
    first, second : Flights; `meshes` are numbers of solids, of the same shape in both
    windows : (n,) float array, s, from 0
    lower, upper : (n,) float array, s: nothing touches from 0 to `lower`, which is the window where nothing ever does;
        at `upper` the bodies touch, and it is inf where they never do. Both are 0 where they touch at the start.
    """

    families: Words
    first: Flights
    second: Flights
    windows: Floats
    lower: Floats
    upper: Floats

    @property
    def number(self) -> int:
        """How many there are."""
        return len(self.windows)

    def some(self, rows: Ints) -> Cases:
        """Some of the cases."""
        return Cases(
            self.families[rows],
            self.first.some(rows),
            self.second.some(rows),
            self.windows[rows],
            self.lower[rows],
            self.upper[rows],
        )


def joined(cases: list[Cases]) -> Cases:
    """Several lists of cases as one."""
    return Cases(
        np.concatenate([c.families for c in cases]),
        stacked([c.first for c in cases]),
        stacked([c.second for c in cases]),
        *(np.concatenate([getattr(c, name) for c in cases]) for name in ("windows", "lower", "upper")),
    )
