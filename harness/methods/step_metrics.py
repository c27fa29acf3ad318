"""What follows from the counters and the clocks of frames: sums, means a frame, and rates."""

from __future__ import annotations

from collections.abc import Mapping

from harness.measure.clocks import Clock

PHASES = ("pair_seconds", "response_seconds", "box_seconds")


def rates(counted: Mapping[str, float], bodies: int, frames: int, simulated: float) -> dict[str, float]:
    """Tests and hits a body, of so many frames and simulated seconds."""
    found = {}
    if "pair_tests" in counted and bodies and frames:
        found["pair_tests_per_body"] = counted["pair_tests"] / (bodies * frames)
    if "pair_hits" in counted and bodies and simulated > 0.0:
        found["collision_rate"] = 2.0 * counted["pair_hits"] / (bodies * simulated)
    return found


def clock_metrics(clock: Clock, frames: int, simulated: float) -> dict[str, float]:
    """The seconds of all phases, and what follows from them, of so many frames and simulated seconds."""
    seconds = clock.metrics()
    for kind in ("", "_elapsed"):
        run = sum(seconds[f"{phase}{kind}"] for phase in PHASES)
        seconds[f"run_seconds{kind}"] = run
        if frames:
            seconds[f"pair_seconds_per_frame{kind}"] = seconds[f"pair_seconds{kind}"] / frames
            seconds[f"box_seconds_per_frame{kind}"] = seconds[f"box_seconds{kind}"] / frames
        if frames and run > 0.0:
            seconds[f"frames_per_second{kind}"] = frames / run
            seconds[f"simulated_per_second{kind}"] = simulated / run
    return seconds
