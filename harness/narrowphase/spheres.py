"""When two spheres in free flight touch: the roots of |gap + velocity t| = reach.

With b = gap . velocity and c = |gap|^2 - reach^2 the first root is c / (-b + sqrt(d)), which cancels nothing. Its
discriminant d is velocity^2 reach^2 - |gap x velocity|^2; with b^2 - velocity^2 c instead, hits are lost from 1e8
diameters away.

What an event loop calls has no branches, so that a loop over pairs runs several at a time. Products are written out,
as the rounding of an operation is that of the function in which it stands, and an event loop's is relaxed.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

from harness.arrays import Floats
from harness.kernel import inner, kernel, step, strict_step
from harness.narrowphase.vectors import Vector

# An approach below this fraction (squared) of |gap| |velocity| is rounding: answering it would not change a velocity,
# and the same hit would be due again, at the same time, forever.
NOISE = 2.0e-31


Coordinates = Vector | Floats


class Products(NamedTuple):
    """Of a gap and a velocity: gap . velocity, gap . gap and velocity . velocity."""

    approach: float
    square: float
    speed: float


class Passage(NamedTuple):
    """From when until when two spheres overlap, s, over all of time; inf and -inf, if they never do."""

    enter: float
    leave: float


@inner
def products(gap: Coordinates, velocity: Coordinates) -> Products:
    return Products(
        gap[0] * velocity[0] + gap[1] * velocity[1] + gap[2] * velocity[2],
        gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2],
        velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2],
    )


@inner
def discriminant(gap: Coordinates, velocity: Coordinates, speed: float, reach: float) -> float:
    """A quarter of that of the quadratic; `speed` is velocity . velocity."""
    miss_x = gap[1] * velocity[2] - gap[2] * velocity[1]
    miss_y = gap[2] * velocity[0] - gap[0] * velocity[2]
    miss_z = gap[0] * velocity[1] - gap[1] * velocity[0]
    return speed * (reach * reach) - (miss_x * miss_x + miss_y * miss_y + miss_z * miss_z)


@inner
def closing(terms: Products) -> bool:
    """Whether a gap is getting smaller, beyond rounding."""
    return (terms.approach < 0.0) & (terms.approach * terms.approach > NOISE * (terms.square * terms.speed))


def time_to_touch(gap: Vector, velocity: Vector, reach: float) -> float:
    """Seconds until |gap + velocity t| = reach, or inf; 0 when overlapping and approaching.

    Parameters
    ----------
    gap : m, from one centre to the other
    velocity : m/s, of the other as seen from the one
    reach : m, sum of the radii
    """
    terms = products(gap, velocity)
    distance = terms.square - reach * reach
    quarter = discriminant(gap, velocity, terms.speed, reach)
    meeting = closing(terms) & ((quarter >= 0.0) | (distance <= 0.0))
    seconds = max(distance, 0.0) / (sqrt(max(quarter, 0.0)) - terms.approach)
    return seconds if meeting else inf


def approaches(gap: Vector, velocity: Vector) -> bool:
    """Whether two spheres close in on each other, beyond rounding; parameters as for `time_to_touch`."""
    return closing(products(gap, velocity))


# as steps of an event loop, with its rounding and with that of all other kernels
strict_time_to_touch = strict_step(time_to_touch)
time_to_touch = step(time_to_touch)
approaches = step(approaches)


@kernel
def passage(gap: Coordinates, velocity: Coordinates, reach: float) -> Passage:
    """From when until when |gap + velocity t| <= reach; parameters as for `time_to_touch`."""
    terms = products(gap, velocity)
    distance = terms.square - reach * reach
    if terms.speed == 0.0:
        return Passage(-inf, inf) if distance <= 0.0 else Passage(inf, -inf)
    quarter = discriminant(gap, velocity, terms.speed, reach)
    if quarter < 0.0:
        return Passage(inf, -inf)
    root = sqrt(quarter)
    if terms.approach < 0.0:
        return Passage(distance / (root - terms.approach), (root - terms.approach) / terms.speed)
    if root + terms.approach == 0.0:
        return Passage(0.0, 0.0)
    return Passage(-(root + terms.approach) / terms.speed, -distance / (root + terms.approach))
