"""Proves every case of a set anew, from nothing but what its folder says."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from harness.errors import Problem
from harness.truth.folder import CASES, TruthSet
from harness.truth.proof import prove

# Cases that are proven together: enough that the arrays are long.
TOGETHER = 100


def check(given: TruthSet, progress: Callable[[str], None]) -> list[Problem]:
    """What could not be proven, each with its line in cases.csv; empty if everything holds."""
    problems = []
    number = given.cases.number
    for begin in range(0, number, TOGETHER):
        rows = np.arange(begin, min(begin + TOGETHER, number))
        for place, reason in zip(rows.tolist(), prove(given.cases.some(rows), given.solids), strict=True):
            if reason:
                problems.append(Problem(reason, CASES, given.lines[place]))
        progress(f"{rows[-1] + 1} of {number} cases, {len(problems)} not proven")
    return problems
