"""Pairs that are never asked about: they are taken out where candidates are found, and so are no events."""

from __future__ import annotations

import numpy as np

from harness.arrays import Pairs
from harness.kernel import step
from harness.motion.predictive.state import Ignored, Indices, World


def ignored_by_label(n: int, pairs: Pairs) -> Ignored:
    """The partners that each of n spheres ignores.

    Parameters
    ----------
    n : spheres
    pairs : (m, 2) int array of labels, i < j, each pair once

    >>> ignored_by_label(3, np.array([[0, 2], [1, 2]]))
    Ignored(first=array([0, 1, 2, 4]), others=array([2, 2, 0, 1]))
    """
    if not len(pairs):
        return Ignored(np.empty(0, np.int64), np.empty(0, np.int64))
    both = np.concatenate([pairs, pairs[:, ::-1]]).astype(np.int64)
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    return Ignored(np.searchsorted(both[:, 0], np.arange(n + 1)), both[:, 1].copy())


@step
def ignores(ignored: Ignored, i: int, j: int) -> bool:
    """Whether the spheres of labels i and j ignore each other, where there are ignored pairs at all."""
    low, high = ignored.first[i], ignored.first[i + 1]
    last = high
    while low < high:
        middle = (low + high) // 2
        if ignored.others[middle] < j:
            low = middle + 1
        else:
            high = middle
    return bool(low < last and ignored.others[low] == j)


@step
def without_ignored(world: World, k: int, candidates: Indices, count: int) -> int:
    """Keep those of `count` candidates that sphere k does not ignore, in their order. Returns how many they are."""
    ignored, schedule = world.ignored, world.spheres.schedule
    if ignored.others.size == 0:
        return count
    label = schedule[k].label
    if ignored.first[label] == ignored.first[label + 1]:
        return count
    kept = 0
    for m in range(count):
        p = candidates[m]
        if not ignores(ignored, label, schedule[p].label):
            candidates[kept] = p
            kept += 1
    return kept
