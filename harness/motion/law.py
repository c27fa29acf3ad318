"""How the bodies of a run move, and for how long: all that a method is told of its motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

from harness.vocabulary import Response


@dataclass(frozen=True)
class MotionLaw:
    """The law of a run's motion.

    Parameters
    ----------
    duration : s of simulated time
    dt : s from frame to frame; without effect where events are computed instead
    response, restitution : of hits, see `harness.motion.response`
    """

    duration: float
    dt: float
    response: Response
    restitution: float = 1.0

    @property
    def frames(self) -> int:
        """The number of frames after the start: frame k is at k·dt, k = 1 … frames."""
        return round(self.duration / self.dt)

    def slowed(self, factor: float) -> MotionLaw:
        """The same law where every time is so many times as long; a power of two changes no digit."""
        return replace(self, duration=self.duration * factor, dt=self.dt * factor)
