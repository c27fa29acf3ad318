"""When a flying sphere meets a plane, or leaves a ball."""

from __future__ import annotations

from math import inf, sqrt

from harness.kernel import step
from harness.motion.predictive.state import Record


@step
def time_to_plane(distance: float, velocity: float) -> float:
    """Seconds to fly `distance` (signed, m) at `velocity` (m/s) along one axis; 0 when already past, inf at rest."""
    return max(distance / velocity, 0.0) if velocity != 0.0 else inf


@step
def time_to_leave(x: float, y: float, z: float, motion: Record, square: float) -> float:
    """When a sphere will be as far from (x, y, z) as the root of `square` (m^2), on its own clock; inf at rest."""
    position, velocity = motion.position, motion.velocity
    x, y, z = position[0] - x, position[1] - y, position[2] - z
    speed = velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]
    outward = x * velocity[0] + y * velocity[1] + z * velocity[2]
    left = square - (x * x + y * y + z * z)
    root = sqrt(max(outward * outward + speed * left, 0.0))
    return motion.time + max((root - outward) / speed, 0.0) if speed > 0.0 else inf
