"""What a hit does to velocities. The normal is the line of centres; only approaching spheres are answered."""

from __future__ import annotations

from typing import NamedTuple

from harness.kernel import step
from harness.motion.predictive.state import Record


class Bounce(NamedTuple):
    """What an elastic hit leaves behind.

    virial : |impulse| times the distance of centres, kg m^2/s
    lost : kinetic energy, J
    """

    virial: float
    lost: float


@step
def bounce(a: Record, b: Record, mass_a: float, mass_b: float, restitution: float) -> Bounce:
    """Equal and opposite impulses; both motions are at the same time."""
    gap_x = b.position[0] - a.position[0]
    gap_y = b.position[1] - a.position[1]
    gap_z = b.position[2] - a.position[2]
    approach = (
        gap_x * (b.velocity[0] - a.velocity[0])
        + gap_y * (b.velocity[1] - a.velocity[1])
        + gap_z * (b.velocity[2] - a.velocity[2])
    )
    # Divided by the actual square of the distance, not by the touching one: energy is then exact whatever the overlap.
    square = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z
    total = mass_a + mass_b
    share_a, share_b = mass_b / total, mass_a / total
    kick = (1.0 + restitution) * (approach / square)
    a.velocity[0] += share_a * kick * gap_x
    a.velocity[1] += share_a * kick * gap_y
    a.velocity[2] += share_a * kick * gap_z
    b.velocity[0] -= share_b * kick * gap_x
    b.velocity[1] -= share_b * kick * gap_y
    b.velocity[2] -= share_b * kick * gap_z
    reduced = mass_a * share_a
    lost = 0.5 * reduced * (1.0 - restitution * restitution) * (approach * (approach / square))
    return Bounce(-(1.0 + restitution) * reduced * approach, lost)


@step
def flip(a: Record, b: Record, mass_a: float, mass_b: float) -> float:
    """Each velocity is mirrored in the plane across the line of centres. Returns the pair's share of the virial."""
    gap_x = b.position[0] - a.position[0]
    gap_y = b.position[1] - a.position[1]
    gap_z = b.position[2] - a.position[2]
    return mirror(a, mass_a, gap_x, gap_y, gap_z) + mirror(b, mass_b, gap_x, gap_y, gap_z)


@step
def mirror(motion: Record, mass: float, x: float, y: float, z: float) -> float:
    """Mirror a velocity along the normal (x, y, z), of any length.

    Returns its change of momentum times its position.
    """
    square = x * x + y * y + z * z
    velocity, position = motion.velocity, motion.position
    kick = -2.0 * ((velocity[0] * x + velocity[1] * y + velocity[2] * z) / square)
    velocity[0] += kick * x
    velocity[1] += kick * y
    velocity[2] += kick * z
    return float(mass * kick * (x * position[0] + y * position[1] + z * position[2]))
