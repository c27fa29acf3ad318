"""How wrong the computed onsets of spheres are: a sample of them, solved again with fifty digits.

Positions and velocities are taken as the exact numbers that they are; paths are folded to the same number of digits.
"""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np

from harness.motion.kinematics import Trajectory
from harness.reference.contacts import Contacts
from harness.scene.bodies import Bodies
from harness.scene.box import Box

DIGITS = 50
SAMPLE = 64
_MOST_STEPS = 200

Vector = tuple[Decimal, ...]


def sphere_onset_error(bodies: Bodies, box: Box, contacts: Contacts) -> float:
    """The largest difference (s) between the onsets of a sample of contacts and the exact ones; 0 without any.

    Parameters
    ----------
    bodies : at time 0
    box : that reflects them
    contacts : of their bounding spheres
    """
    begins = np.flatnonzero(contacts.onset > 0.0)
    begins = begins[np.argsort(contacts.onset[begins], kind="stable")]
    # spread over the duration, the last among them: late times have the fewest digits
    chosen = begins[np.unique(np.linspace(len(begins) - 1, 0, SAMPLE).astype(np.int64))] if len(begins) else begins
    with localcontext() as context:
        context.prec = DIGITS
        paths = _DecimalPaths(bodies, box)
        pairs = contacts.pairs[contacts.encounter[chosen]].tolist()
        times = contacts.onset[chosen].tolist()
        errors = [abs(paths.onset(i, j, time) - Decimal(time)) for (i, j), time in zip(pairs, times, strict=True)]
        return float(max(errors, default=Decimal(0)))


class _DecimalPaths:
    """Folded paths of bodies, exact but for the fiftieth digit. Made and used within a context of so many digits."""

    def __init__(self, bodies: Bodies, box: Box) -> None:
        self._origins = [tuple(map(Decimal, row)) for row in bodies.positions.tolist()]
        velocities = Trajectory(bodies, box, folded=True, turning=False).velocities
        self._velocities = [tuple(map(Decimal, row)) for row in velocities.tolist()]
        half = [Decimal(side) for side in box.half.tolist()]
        self._radii = [Decimal(radius) for radius in bodies.radii.tolist()]
        self._rooms = [tuple(max(side - radius, Decimal(0)) for side in half) for radius in self._radii]

    def onset(self, i: int, j: int, near: float) -> Decimal:
        """When two bodies begin to touch, s, by Newton's method from a time near it."""
        reach = self._radii[i] + self._radii[j]
        time = Decimal(near)
        for _ in range(_MOST_STEPS):
            (x, v), (y, w) = self._at(i, time), self._at(j, time)
            gap, velocity = _difference(y, x), _difference(w, v)
            slope = 2 * _product(gap, velocity)
            step = (_product(gap, gap) - reach * reach) / slope if slope else Decimal(0)
            time -= step
            if abs(step) <= Decimal(10) ** (12 - DIGITS) * max(abs(time), Decimal(1)):
                break
        return time

    def _at(self, body: int, time: Decimal) -> tuple[Vector, Vector]:
        place = zip(self._origins[body], self._velocities[body], self._rooms[body], strict=True)
        axes = [_folded(x, v, half, time) for x, v, half in place]
        return tuple(x for x, _ in axes), tuple(v for _, v in axes)


def _folded(x: Decimal, v: Decimal, half: Decimal, time: Decimal) -> tuple[Decimal, Decimal]:
    """Coordinate and velocity on one axis: the straight line, mirrored into [-half, half]."""
    y = x + v * time
    if -half <= y <= half:
        return y, v
    if half == 0:
        return Decimal(0), Decimal(0)
    phase = (y + half) % (4 * half)  # has the sign of y + half
    phase += 4 * half if phase < 0 else 0
    return (phase - half, v) if phase <= 2 * half else (3 * half - phase, -v)


def _difference(a: Vector, b: Vector) -> Vector:
    return tuple(p - q for p, q in zip(a, b, strict=True))


def _product(a: Vector, b: Vector) -> Decimal:
    return sum((p * q for p, q in zip(a, b, strict=True)), Decimal(0))
