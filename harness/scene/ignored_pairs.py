"""Pairs that are never asked about, such as the neighbouring links of a robot."""

from __future__ import annotations

import numpy as np

from harness.arrays import Flags, Pairs


def kept(pairs: Pairs, ignored: Pairs) -> Flags:
    """Which pairs are not ignored, (k,).

    Parameters
    ----------
    pairs : (k, 2) int array, i < j
    ignored : (m, 2) int array, i < j, sorted

    >>> kept(np.array([[0, 1], [0, 2]]), np.array([[0, 1]])).tolist()
    [False, True]
    """
    flags: Flags = ~np.isin(pairs[:, 0] << 32 | pairs[:, 1], ignored[:, 0] << 32 | ignored[:, 1])
    return flags


def without(pairs: Pairs, ignored: Pairs) -> Pairs:
    """The pairs that are not ignored; parameters as for `kept`."""
    return pairs[kept(pairs, ignored)] if len(ignored) else pairs
