"""The machine while a run went on: load, time stolen by a hypervisor, clock rate. Read before and after, never during.

A quiet machine repeats times within a per cent; these numbers say how quiet it was.
"""

from __future__ import annotations

import os
from time import perf_counter

import psutil

# What each condition is, and its unit.
CONDITIONS: dict[str, tuple[str, str]] = {
    "load": ("processes that wanted to run, mean of the last minute, when the run began", "1"),
    "steal": ("share of all processor time that other guests of the same host took while the run went on", "%"),
    "frequency": ("clock rate when the run had ended", "Hz"),
    "core": ("number of the core that the run was kept on", "1"),
    "seconds": ("elapsed time of the run with everything around it", "s"),
    "flights": ("how often the scene was flown, to make the sample long enough", "1"),
}


class Conditions:
    """Taken from construction to `metrics`.

    Parameters
    ----------
    pinned : choose a core for the run, as `core`: the one that was idlest since the last choice
    """

    def __init__(self, pinned: bool) -> None:
        self.core = _idlest() if pinned else None
        self._load = os.getloadavg()[0]
        self._times = psutil.cpu_times()
        self._began = perf_counter()

    def metrics(self) -> dict[str, float]:
        """The conditions so far; those that the system does not tell are left out."""
        found = {"seconds": perf_counter() - self._began, "load": self._load}
        times = psutil.cpu_times()
        passed = sum(times) - sum(self._times)
        if passed > 0 and hasattr(times, "steal"):
            found["steal"] = 100.0 * (times.steal - self._times.steal) / passed
        frequency = psutil.cpu_freq() if hasattr(psutil, "cpu_freq") else None
        if frequency is not None and frequency.current > 0:
            found["frequency"] = frequency.current * 1e6
        if self.core is not None:
            found["core"] = self.core
        return found


_idle: dict[int, float] = {}


def _idlest() -> int | None:
    """The core, of those this process may use, with the most idle time since the last call."""
    if not hasattr(os, "sched_getaffinity"):
        return None
    now = {core: times.idle for core, times in enumerate(psutil.cpu_times(percpu=True))}
    allowed = sorted(os.sched_getaffinity(0) & now.keys())
    since = {core: now[core] - _idle.get(core, 0.0) for core in allowed}
    _idle.update(now)
    return max(allowed, key=lambda core: since[core], default=None)
