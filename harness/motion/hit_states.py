"""The state of the bodies of every hit: where they were, their velocities before and after it, the impulse of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.motion.response import CollisionResponse


@dataclass(frozen=True, eq=False)
class HitStates:
    """What the bodies of k hits did, in the order of the hits; NaN for the second body where a wall was hit.

    Parameters
    ----------
    positions : (k, 2, 3) float array, m, of the centres of both bodies at the time of the hit
    velocities_before, velocities_after : (k, 2, 3) float arrays, m/s
    impulses : (k, 2, 3) float array, kg m/s, what each body received: its mass by the change of its velocity
    """

    positions: Floats
    velocities_before: Floats
    velocities_after: Floats
    impulses: Floats

    def rows(self) -> Iterator[dict[str, list[list[float]]]]:
        """One hit after another, each array by its name as two lists of x, y, z."""
        names = [field.name for field in fields(self)]
        for hit in zip(*(getattr(self, name).tolist() for name in names), strict=True):
            yield dict(zip(names, hit, strict=True))


def states_of_events(records: Any, bodies: Pairs, masses: Floats) -> HitStates:
    """The states of the events of a predictive simulation.

    Parameters
    ----------
    records : (k,) array of its `EVENT_STATE`
    bodies : (k, 2) int array; the second is -1 where a wall was hit
    masses : (n,) float array, kg
    """
    flown = (records["now"][:, None] - records["time"])[:, :, None]
    # most were brought to the time of the event, where 0 s are flown
    positions = records["position"] + records["before"] * flown
    impulses = masses[bodies][:, :, None] * (records["after"] - records["before"])
    nobody = (bodies < 0)[:, :, None]
    arrays = (positions, records["before"], records["after"], impulses)
    return HitStates(*(np.where(nobody, np.nan, values) for values in arrays))


class HitStateLog:
    """Collects the states of hits, one after another.

    Parameters
    ----------
    masses : (n,) float array, kg
    """

    def __init__(self, masses: Floats) -> None:
        self._masses = masses
        self._rows: list[Floats] = []

    def add(self, i: int, j: int, positions: Floats, before: Floats, after: Floats) -> None:
        """Append a hit of bodies i and j, or of body i and a wall (then j is -1).

        Parameters
        ----------
        positions : (n, 3) float array, m, of all bodies
        before, after : (n, 3) float arrays, m/s, of all bodies
        """
        row = np.full((4, 2, 3), np.nan)
        for place, body in enumerate((i,) if j < 0 else (i, j)):
            impulse = self._masses[body] * (after[body] - before[body])
            row[:, place] = positions[body], before[body], after[body], impulse
        self._rows.append(row)

    def add_passing(self, pairs: Pairs, walls: Ints, positions: Floats, velocities: Floats) -> None:
        """Append the hits of a frame in which nothing is answered: pairs that begin to touch, walls that fold paths.

        Of a wall the velocity before it points outward, and that after it inward, whatever the body met since.

        Parameters
        ----------
        pairs : (k, 2) int array
        walls : (n, 6) int array, how often which body met which wall
        positions, velocities : (n, 3) float arrays, m and m/s, at the time of the frame
        """
        for i, j in pairs.tolist():
            self.add(i, j, positions, velocities, velocities)
        for wall, body in np.argwhere(walls.T).tolist():
            axis, outward = wall // 2, 1.0 if wall % 2 else -1.0
            before, after = velocities.copy(), velocities.copy()
            before[body, axis] = outward * abs(velocities[body, axis])
            after[body, axis] = -before[body, axis]
            for _ in range(int(walls[body, wall])):
                self.add(body, -1, positions, before, after)

    def states(self) -> HitStates:
        """All of them."""
        return HitStates(*np.moveaxis(np.array(self._rows).reshape(-1, 4, 2, 3), 1, 0))


class RecordedResponse(CollisionResponse):
    """Answers contacts as its base does, to the bit, and keeps the state of the bodies of each that it answered.

    It hands them to the same kernels one at a time, as one kernel call for all of them shows no velocity in between.

    Parameters
    ----------
    masses, response, restitution : as of `CollisionResponse`
    positions : (n, 3) float array, m, overwritten from frame to frame by whoever moves the bodies

    Attributes
    ----------
    log : HitStateLog
    """

    def __init__(
        self, masses: Floats, response: Literal["reflect", "elastic"], restitution: float, positions: Floats
    ) -> None:
        super().__init__(masses, response, restitution)
        self.log = HitStateLog(masses)
        self._positions = positions

    def pairs(self, pairs: Pairs, positions: Floats, velocities: Floats) -> Flags:
        hits = np.zeros(len(pairs), np.bool_)
        for k, (i, j) in enumerate(pairs.tolist()):
            before = velocities.copy()
            hits[k] = super().pairs(pairs[k : k + 1], positions, velocities)[0]
            if hits[k]:
                self.log.add(i, j, positions, before, velocities)
        return hits

    def walls(self, touching: Flags, velocities: Floats) -> Flags:
        hits = np.zeros_like(touching)
        for wall, body in np.argwhere(touching.T).tolist():
            alone = np.zeros_like(touching)
            alone[body, wall] = True
            before = velocities.copy()
            if super().walls(alone, velocities)[body, wall]:
                hits[body, wall] = True
                self.log.add(body, -1, self._positions, before, velocities)
        return hits
