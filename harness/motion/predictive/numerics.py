"""When a flying sphere meets a plane."""

from __future__ import annotations

from math import inf

from harness.kernel import step


@step
def time_to_plane(distance: float, velocity: float) -> float:
    """Seconds to fly `distance` (signed, m) at `velocity` (m/s) along one axis; 0 when already past, inf at rest."""
    return max(distance / velocity, 0.0) if velocity != 0.0 else inf
