"""What bodies do when they touch: velocities after hits, both bodies treated as spheres.

The normal of a pair is its line of centres. A pair or a wall answers only while it approaches along its normal; that is
what keeps overlapping bodies from sticking. Concentric bodies have no normal and are left alone.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from harness.arrays import Flags, Floats, Pairs
from harness.kernel import kernel

# m^2. Centres nearer than its root have a direction, but a square that is rounded off; a power of two, which rounds
# nothing, brings them apart; twice for the smallest of all.
_SMALLEST_SQUARE, _MUCH = 1e-280, 2.0**500


class CollisionResponse:
    """Answers the contacts of bodies, and remembers whose velocity changed.

    Parameters
    ----------
    masses : (n,) float array, kg
    response : {"reflect", "elastic"}
        `reflect` flips each body's velocity component along the normal. `elastic` gives equal and opposite impulses
        that turn the approach speed u into restitution * u apart. Walls flip the component along their normal.
    restitution : float
        0 … 1, for `elastic`.

    Attributes
    ----------
    changed : (n,) bool array; bodies answered since it was last cleared
    momentum_added : largest norm of the momentum that answers to pairs have added up to, kg m/s
    """

    def __init__(self, masses: Floats, response: Literal["reflect", "elastic"], restitution: float) -> None:
        self.changed = np.zeros(len(masses), np.bool_)
        self._masses = masses
        self.elastic = response == "elastic"
        self._restitution = restitution
        # x, y, z of the momentum added so far, and the largest square of its norm
        self._added = np.zeros(4)

    @property
    def momentum_added(self) -> float:
        return float(np.sqrt(self._added[3]))

    def pairs(self, pairs: Pairs, positions: Floats, velocities: Floats) -> Flags:
        """Answer touching pairs one after another, each with the velocities that the earlier ones left.

        Parameters
        ----------
        pairs : (k, 2) int array, in the order in which they are answered
        positions : (n, 3) float array, m
        velocities : (n, 3) float array, m/s; changed in place

        Returns
        -------
        (k,) bool array
            The pairs that were approaching, and so were answered.
        """
        hits = np.empty(len(pairs), np.bool_)
        answer_pairs(
            pairs, positions, velocities, self._masses, self.elastic, self._restitution, self._added, self.changed, hits
        )
        return hits

    def walls(self, touching: Flags, velocities: Floats) -> Flags:
        """Answer wall contacts, wall after wall.

        Parameters
        ----------
        touching : (n, 6) bool array; which body touches which of the walls x-, x+, y-, y+, z-, z+
        velocities : (n, 3) float array, m/s; changed in place

        Returns
        -------
        (n, 6) bool array
            The contacts that were approaching, and so were answered.
        """
        hits = np.empty_like(touching)
        _answer_walls(touching, velocities, self.changed, hits)
        return hits


@kernel
def answer_pairs(
    pairs: Pairs,
    positions: Floats,
    velocities: Floats,
    masses: Floats,
    elastic: bool,
    restitution: float,
    added: Floats,
    changed: Flags,
    hits: Flags,
) -> None:
    """The kernel of `CollisionResponse.pairs`.

    Written are `added` (x, y, z and the square of a norm), `changed` and `hits`.
    """
    for k in range(len(pairs)):
        i, j = pairs[k]
        gap = positions[j] - positions[i]
        square = np.dot(gap, gap)
        for _ in range(2):
            if square < _SMALLEST_SQUARE:
                gap *= _MUCH
                square = np.dot(gap, gap)
        approach = np.dot(velocities[j] - velocities[i], gap)
        hits[k] = approach < 0.0
        if not hits[k]:
            continue
        changed[i] = changed[j] = True
        before = masses[i] * velocities[i] + masses[j] * velocities[j]
        if elastic:
            # divided by the actual square of the distance, so that energy is exact despite an overlap
            impulse = (1.0 + restitution) * approach / square * (masses[i] / (masses[i] + masses[j]) * masses[j])
            velocities[i] += impulse / masses[i] * gap
            velocities[j] -= impulse / masses[j] * gap
        else:
            velocities[i] -= 2.0 * np.dot(velocities[i], gap) / square * gap
            velocities[j] -= 2.0 * np.dot(velocities[j], gap) / square * gap
        added[:3] += masses[i] * velocities[i] + masses[j] * velocities[j] - before
        added[3] = max(added[3], np.dot(added[:3], added[:3]))


@kernel
def _answer_walls(touching: Flags, velocities: Floats, changed: Flags, hits: Flags) -> None:
    for wall in range(6):
        axis = wall // 2
        outward = -1.0 if wall % 2 == 0 else 1.0
        for i in range(len(velocities)):
            hits[i, wall] = touching[i, wall] and outward * velocities[i, axis] > 0.0
            if hits[i, wall]:
                velocities[i, axis] = -velocities[i, axis]
                changed[i] = True
