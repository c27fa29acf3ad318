"""Hard spheres in a reflecting box, flown from event to event."""

from __future__ import annotations

from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.arrays import Floats, Pairs
from harness.errors import InputError
from harness.motion.predictive.codes import Event, NeighbourSearch, Stop
from harness.motion.predictive.flight import fly, fly_deep, fly_several, fly_several_deep, populate
from harness.motion.predictive.grids import empty_grids, ratio_classes
from harness.motion.predictive.initial import check
from harness.motion.predictive.order import labelled, positions_at, reorder
from harness.motion.predictive.preparation import empty_lists, prepare
from harness.motion.predictive.rules import DEEP_PREFETCH_COUNT, RESPONSES, SEARCHES, choose_search, make_rules


class Simulation:
    """Exact motion of spheres that meet each other and the walls of a box.

    Parameters
    ----------
    positions, velocities : (n, 3) array_like, m and m/s; the box is centred at the origin
    radii, masses : (n,) array_like, m and kg
    half_box : (3,) array_like, m, half the sides
    response : 'reflect' (each velocity's normal component is mirrored), 'elastic' (impulses by mass) or 'none' (spheres
        pass through each other, and a pair event is the onset of touching)
    restitution : of elastic pair hits, 0 to 1; walls give everything back
    record : keep the events, for `events` and `take_events`
    states : keep the states of their spheres as well, for `take_states`
    search : 'cells', 'lists', or None to choose by packing
    ignored : (m, 2) int array of pairs i < j that fly through each other unnoticed, each once; None: no such pairs

    Raises
    ------
    InputError
        If an array has a wrong shape or value, or spheres like these cannot be flown as asked.
    """

    COUNTERS: ClassVar[tuple[str, ...]] = (
        "pair_hits",
        "box_hits",
        "predictions",
        "pair_tests",
        "stale_events",
        "cell_crossings",
        "list_renewals",
        "guarded_hits",
        "stalled_events",
    )

    def __init__(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        radii: ArrayLike,
        masses: ArrayLike,
        half_box: ArrayLike,
        response: str = "reflect",
        restitution: float = 1.0,
        *,
        record: bool = False,
        states: bool = False,
        search: str | None = None,
        ignored: Pairs | None = None,
    ) -> None:
        start = check(positions, velocities, radii, masses, half_box)
        if response not in RESPONSES:
            raise InputError(f'response must be one of {", ".join(RESPONSES)}, not "{response}"')
        if not 0.0 <= restitution <= 1.0:
            raise InputError(f"restitution must lie between 0 and 1, not {restitution:g}")
        search = search or choose_search(start, response)
        if search not in SEARCHES or (search == "lists" and ratio_classes(start.radii).max(initial=0) > 0):
            raise InputError(f'search "{search}" is not possible for these spheres')
        self._chunks: list[NDArray[np.void]] = []
        self._states: list[NDArray[np.void]] = []
        rules = make_rules(start, response, float(restitution), search)
        none = np.empty((0, 2), np.int64)
        self._world = prepare(start, rules, none if ignored is None else ignored, record, states)
        self._start = start
        self._start_virial = self._momentum_by_position(start.positions)
        self.time = 0.0
        self._populate(False)

    def __len__(self) -> int:
        return len(self._start)

    # -- motion ------------------------------------------------------------------------------------------------------

    def advance(self, until: float, max_events: int | None = None) -> bool:
        """Fly to `until` (s); what is due at that very time still happens. False if `max_events` hits came first."""
        budget = 2**62 if max_events is None else self.counters["events"] + max_events
        while (reason := self._fly(float(until), budget)) in (Stop.FULL, Stop.NO_ROOM, Stop.REORDER):
            if reason == Stop.FULL:
                self._chunks.append(self._drain())
            elif reason == Stop.NO_ROOM:
                self._make_room()
            else:
                reorder(self._world)
                self._populate(True)
        if reason == Stop.SPENT:
            self.time = self._last_event_time
            return False
        self.time = max(self.time, until)
        return True

    def positions_at(self, time: float) -> Floats:
        """(n, 3) positions at a time not before the last event, m. Flies there if need be; moves nothing else."""
        if time < self._last_event_time:
            raise ValueError(f"t = {time!r} s is past: the last event was at {self._last_event_time!r} s")
        if time > self.time:
            self.advance(time)
        clock = self._world.totals.clock[0]
        now = float((time - clock["epoch"]) - clock["epoch_rest"])
        return labelled(self._world, positions_at(self._world, now))

    @property
    def positions(self) -> Floats:
        """(n, 3) positions at `time`, m."""
        return self.positions_at(self.time)

    @property
    def velocities(self) -> Floats:
        """(n, 3) velocities at `time`, m/s."""
        return labelled(self._world, self._world.spheres.motions["velocity"])

    # -- events ------------------------------------------------------------------------------------------------------

    @property
    def events(self) -> NDArray[np.void]:
        """All recorded events not yet taken, structured: time (s), kind (an `Event`), i, j or -1, wall or -1."""
        self._chunks = [np.concatenate([*self._chunks, self._drain()])]
        return self._chunks[0]

    def take_events(self) -> NDArray[np.void]:
        """The recorded events, which are then forgotten here: to write a long run out piece by piece."""
        taken = self.events
        self._chunks = []
        return taken

    def take_states(self) -> NDArray[np.void]:
        """The states of the recorded events not yet taken, one of `EVENT_STATE` each, which are then forgotten here."""
        self._chunks.append(self._drain())
        taken = np.concatenate(self._states)
        self._states = []
        return taken

    # -- what was counted --------------------------------------------------------------------------------------------

    @property
    def counters(self) -> dict[str, int]:
        """How often what happened; `events` are pair and box hits only."""
        counts = self._world.totals.counts[0]
        return {"events": int(counts["pair_hits"] + counts["box_hits"])} | {
            name: int(counts[name]) for name in self.COUNTERS
        }

    @property
    def search(self) -> str:
        """Where neighbours come from: 'cells' or 'lists'."""
        return next(name for name, code in SEARCHES.items() if code == self._world.rules.neighbours)

    # -- physics -----------------------------------------------------------------------------------------------------

    @property
    def kinetic_energy(self) -> float:
        """Of the centres, J."""
        return float(0.5 * (self._start.masses * (self.velocities**2).sum(axis=1)).sum())

    @property
    def collision_rate(self) -> float:
        """Pair hits of a sphere in a second, from the start."""
        return 2.0 * self.counters["pair_hits"] / (len(self) * self.time) if len(self) and self.time else 0.0

    @property
    def wall_impulses(self) -> Floats:
        """(6,) impulses given to x-, x+, y-, y+, z-, z+ since the start, kg m/s."""
        impulses: Floats = self._world.totals.wall_impulses["total"].copy()
        return impulses

    @property
    def pair_impulses(self) -> float:
        """Sum over pair hits of |impulse| times the distance of centres, kg m^2/s (for 'reflect', its counterpart)."""
        return self._sum("pair_virial")

    @property
    def pressure(self) -> float:
        """Mean force on the walls to the area their centres can reach, (side - mean diameter)^2, Pa."""
        if not len(self) or not self.time:
            return 0.0
        sides = 2.0 * np.maximum(self._start.half_box - self._start.radii.mean(), 0.0)
        area = 2.0 * (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0])
        return float(self.wall_impulses.sum() / (self.time * area)) if area else inf

    @property
    def virial_residual(self) -> float:
        """Imbalance of d(sum m r.v) = 2 KE T + sum |dp| r12 - sum |dp| a/2, to the second of these terms."""
        change = self._momentum_by_position(self.positions) - self._start_virial
        action = 2.0 * (self.kinetic_energy * self.time + self._sum("lost_energy_time"))
        balance = change - action - self._sum("pair_virial") + self._sum("wall_virial")
        return balance / action if action else 0.0

    @property
    def lost_energy(self) -> float:
        """Kinetic energy that inelastic hits took, J."""
        return self._sum("lost_energy")

    # -- inside ------------------------------------------------------------------------------------------------------

    @property
    def _last_event_time(self) -> float:
        clock = self._world.totals.clock[0]
        return float(clock["epoch"] + (clock["epoch_rest"] + clock["now"]))

    def _sum(self, name: str) -> float:
        return float(self._world.totals.sums[name]["total"][0])

    def _momentum_by_position(self, positions: Floats) -> float:
        return float((self._start.masses * (positions * self.velocities).sum(axis=1)).sum())

    def _drain(self) -> NDArray[np.void]:
        counts = self._world.totals.counts[0]
        chunk: NDArray[np.void] = self._world.log[: counts["recorded"]].copy()
        if len(self._world.states):
            self._states.append(self._world.states[: counts["recorded"]].copy())
        counts["recorded"] = 0
        return chunk

    def _fly(self, until: float, budget: int) -> Stop:
        deep, several = len(self) >= DEEP_PREFETCH_COUNT, len(self._world.cells.grids) > 1
        if several:
            return (fly_several_deep if deep else fly_several)(self._world, until, budget)
        return (fly_deep if deep else fly)(self._world, until, budget)

    def _populate(self, placed: bool) -> None:
        if not populate(self._world, placed):
            self._make_room()

    def _make_room(self) -> None:
        """Go on with cells from this moment: more spheres are on top of each other than a roster holds."""
        world = self._world
        now = float(world.totals.clock["now"][0])
        motions = world.spheres.motions
        motions["position"] = positions_at(world, now)
        motions["time"] = now
        leaves = len(world.queue.times) // 2
        world.spheres.schedule["kind"] = Event.UNSCHEDULED
        world.queue.times[leaves : leaves + len(self)] = now
        self._world = world._replace(
            cells=empty_grids(self._start.half_box, self._start.radii, 0.0),
            lists=empty_lists(motions, NeighbourSearch.CELLS, 0),
            rules=world.rules._replace(neighbours=NeighbourSearch.CELLS.value, skin=0.0),
        )
        populate(self._world, False)
