"""How the bodies of a run move, and for how long: all that a method needs to know of its motion."""

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
    times : (f + 1,) s, of the start and the frames, where poses were recorded; else frames are `dt` apart
    """

    duration: float
    dt: float
    response: Response
    restitution: float = 1.0
    times: tuple[float, ...] | None = None

    @property
    def frames(self) -> int:
        """The number of frames after the start: frame k is at k·dt, k = 1 … frames.

        >>> MotionLaw(duration=10.0, dt=1 / 60, response="reflect").frames
        600
        """
        return round(self.duration / self.dt) if self.times is None else len(self.times) - 1

    def time_of(self, frame: int) -> float:
        """s; of the start, which is frame 0, and of frames."""
        return frame * self.dt if self.times is None else self.times[frame]

    def slowed(self, factor: float) -> MotionLaw:
        """The same law with every time multiplied by a factor; a power of two changes no digit.

        >>> MotionLaw(duration=10.0, dt=0.1, response="none").slowed(2.0)
        MotionLaw(duration=20.0, dt=0.2, response='none', restitution=1.0, times=None)
        """
        times = None if self.times is None else tuple(factor * time for time in self.times)
        return replace(self, duration=self.duration * factor, dt=self.dt * factor, times=times)

    def beginning(self, share: float) -> MotionLaw:
        """The same law for a share of the time, one frame at least.

        >>> MotionLaw(duration=10.0, dt=0.1, response="none").beginning(0.25)
        MotionLaw(duration=2.5, dt=0.1, response='none', restitution=1.0, times=None)
        """
        if self.times is not None:
            times = self.times[: max(2, round(share * len(self.times)))]
            return replace(self, duration=times[-1], times=times)
        return replace(self, duration=min(self.duration, max(self.duration * share, self.dt)))
