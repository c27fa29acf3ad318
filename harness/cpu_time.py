"""CPU time of this process, with that of work which a child did in its place.

A library that may hang is asked in a child process, which can be ended; what it computes there is still the cost of the
answer, but no part of what the system counts for this process.
"""

from __future__ import annotations

from time import process_time

_of_children = 0.0


def cpu_time() -> float:
    """s of CPU time that this process has used, what was charged to it included."""
    return process_time() + _of_children


def charged() -> float:
    """s of it that children used in its place."""
    return _of_children


def charge(seconds: float) -> None:
    """Count CPU time, s, that a child used for an answer to this process."""
    global _of_children
    _of_children += seconds
