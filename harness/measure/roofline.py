"""How far a frame is from what memory allows: the traffic that it cannot do without, at the speed of a plain copy."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from time import perf_counter

import numpy as np

NAMES = ("copy_bandwidth", "frame_bytes_per_body", "times_of_memory")

# B a body and frame, of double precision: places and velocities are read, places written.
_PLACED = 3 * 3 * 8
# Orientations and spins are read, orientations written.
_TURNED = (4 + 3 + 4) * 8
# Larger than any cache of a processor; copied so often that one of the copies is undisturbed.
_COPIED, _COPIES = 2**27, 5


def roofline(names: Collection[str], bodies: int, turning: bool, metrics: Mapping[str, float]) -> dict[str, float]:
    """The metrics of this module for a run of frames, if one of them is named: a ratio is read beside what it is of.

    Parameters
    ----------
    names : of metrics
    bodies : in the scene
    turning : whether orientations are followed
    metrics : of the run; without `frames` nothing is said
    """
    frames, seconds = metrics.get("frames", 0.0), metrics.get("run_seconds", 0.0)
    if not bodies or not frames or not seconds or not any(name in names for name in NAMES):
        return {}
    bandwidth, traffic = copy_bandwidth(), float(least_traffic(turning))
    return dict(zip(NAMES, (bandwidth, traffic, seconds / frames * bandwidth / (traffic * bodies)), strict=True))


def least_traffic(turning: bool) -> int:
    """B a body that a frame which places every body cannot do without.

    Examples
    --------
    >>> least_traffic(False), least_traffic(True)
    (72, 160)
    """
    return _PLACED + (_TURNED if turning else 0)


def copy_bandwidth() -> float:
    """B/s that one core reads and writes while it copies an array larger than its caches: the best of some copies."""
    source = np.zeros(_COPIED, np.uint8)
    target = np.ones_like(source)  # touched once, so that no copy waits for its pages
    source[:] = 1
    fastest = np.inf
    for _ in range(_COPIES):
        begun = perf_counter()
        np.copyto(target, source)
        fastest = min(fastest, perf_counter() - begun)
    return 2 * _COPIED / fastest
