"""Names for the kinds of array in signatures; their shapes and units are in the docstrings."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]
Pairs: TypeAlias = NDArray[np.int64]
"""(k, 2), body numbers i < j, sorted."""
