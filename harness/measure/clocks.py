"""Clocks: CPU time and elapsed time of the phases of a run.

CPU time leads, because on a shared machine it repeats within a few per cent where elapsed time varies several-fold.
"""

from __future__ import annotations

from time import perf_counter

from harness.cpu_time import cpu_time


class Clock:
    """Splits a loop into phases: each `lap` charges the time since the last one to a phase.

    Reading costs about a microsecond; every lap carries one reading.
    """

    def __init__(self, *phases: str) -> None:
        self.cpu = dict.fromkeys(phases, 0.0)
        self.elapsed = dict.fromkeys(phases, 0.0)
        self.start()

    def start(self) -> None:
        """Begin a lap that leaves out everything since the last one."""
        self._elapsed = perf_counter()
        self._cpu = cpu_time()

    def lap(self, phase: str) -> None:
        """Charge the time since the last lap or start to `phase`, and begin the next lap."""
        cpu, elapsed = cpu_time(), perf_counter()
        self.cpu[phase] += cpu - self._cpu
        self.elapsed[phase] += elapsed - self._elapsed
        self._cpu, self._elapsed = cpu, elapsed

    def metrics(self) -> dict[str, float]:
        """Seconds of each phase, as `phase` (CPU) and `phase_elapsed`."""
        return self.cpu | {f"{phase}_elapsed": seconds for phase, seconds in self.elapsed.items()}
