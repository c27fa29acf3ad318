"""When two flying spheres touch, and when one meets a plane.

Everything here is written without branches, so that the pair loop in `search` runs several pairs at a time.
"""

from __future__ import annotations

from math import inf, sqrt

from harness.kernel import step, strict_step

# An approach below this fraction (squared) of |gap| |velocity| is rounding: answering it would not change a velocity,
# and the same hit would be due again, at the same time, forever.
NOISE = 2.0e-31


def time_to_touch(
    gap_x: float, gap_y: float, gap_z: float, velocity_x: float, velocity_y: float, velocity_z: float, reach: float
) -> float:
    """Seconds until |gap + velocity t| = reach, or inf; 0 when overlapping and approaching.

    Gap in m (from one centre to the other), velocity in m/s (of the other, seen from the one), reach: sum of radii.
    """
    approach = gap_x * velocity_x + gap_y * velocity_y + gap_z * velocity_z
    square = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z
    speed = velocity_x * velocity_x + velocity_y * velocity_y + velocity_z * velocity_z
    # |gap x velocity| instead of approach^2 - speed * distance: exact from 1e8 diameters away
    miss_x = gap_y * velocity_z - gap_z * velocity_y
    miss_y = gap_z * velocity_x - gap_x * velocity_z
    miss_z = gap_x * velocity_y - gap_y * velocity_x
    distance = square - reach * reach
    discriminant = speed * (reach * reach) - (miss_x * miss_x + miss_y * miss_y + miss_z * miss_z)
    nearing = (approach < 0.0) & (approach * approach > NOISE * (square * speed))
    meeting = nearing & ((discriminant >= 0.0) | (distance <= 0.0))
    seconds = max(distance, 0.0) / (sqrt(max(discriminant, 0.0)) - approach)
    return seconds if meeting else inf


strict_time_to_touch = strict_step(time_to_touch)
time_to_touch = step(time_to_touch)


@step
def time_to_plane(distance: float, velocity: float) -> float:
    """Seconds to fly `distance` (signed, m) at `velocity` (m/s) along one axis; 0 when already past, inf at rest."""
    return max(distance / velocity, 0.0) if velocity != 0.0 else inf


@step
def approaches(
    gap_x: float, gap_y: float, gap_z: float, velocity_x: float, velocity_y: float, velocity_z: float
) -> bool:
    """Whether two spheres close in on each other, beyond rounding."""
    approach = gap_x * velocity_x + gap_y * velocity_y + gap_z * velocity_z
    square = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z
    speed = velocity_x * velocity_x + velocity_y * velocity_y + velocity_z * velocity_z
    return (approach < 0.0) & (approach * approach > NOISE * (square * speed))
