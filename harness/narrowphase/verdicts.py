"""What a kernel can say of two bodies: at one instant, and at the end of a search through time.

Kernels and their callers compare with the members of these two enumerations and with no number.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Flags


class PairVerdict(IntEnum):
    """What is proved of two bodies at one instant; UNDECIDED, if they are nearer to touching than rounding can tell."""

    SEPARATE = 0
    TOUCHING = 1
    UNDECIDED = 2


class SearchVerdict(IntEnum):
    """How a search through a window of time ended.

    NEVER: what is searched for does not happen until the end of the window. FOUND: it happens at the time that is said.
    STALLED: the search was given up, and it does not happen before the time that is said.
    """

    NEVER = 0
    FOUND = 1
    STALLED = 2


PairVerdicts: TypeAlias = NDArray[np.int8]
"""(k,) of PairVerdict, one a pair."""


def which(verdicts: PairVerdicts, verdict: PairVerdict) -> Flags:
    """(k,) bool array: the pairs of this verdict."""
    # numpy takes five times as long to compare with the member itself
    flags: Flags = verdicts == verdict.value
    return flags
