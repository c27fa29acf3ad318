"""Bodies of any shape in a reflecting box, flown from event to event."""

from __future__ import annotations

import numpy as np

from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.solid_flight import fly_solids
from harness.motion.predictive.solids import Form, SolidWorld, solids
from harness.motion.predictive.windows import enlarged, windows
from harness.scene.bodies import Bodies
from harness.scene.box import Box

# Counters of the narrow searches.
SEARCHES = ("narrow_tests", "box_tests", "advancement_steps")
# Windows that a body has room for at first.
WINDOWS = 6
# Hits in no time that make a body stall: fewer than of spheres, as each costs the searches of all that overlap.
BURST = {"none": 30, "reflect": 1000, "elastic": 10_000}


class SolidSimulation(Simulation):
    """Motion of spinning hulls or meshes, each contact found to a tolerance.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    form : Form of the bodies
    response, restitution, record : as of `Simulation`
    tolerance : gap, relative to the mean size of two bodies, at which surfaces count as touching
    """

    def __init__(
        self,
        bodies: Bodies,
        box: Box,
        form: Form,
        response: str = "reflect",
        restitution: float = 1.0,
        record: bool = False,
        tolerance: float = 1e-6,
    ) -> None:
        # Spheres that meet when the shapes inside can be within the tolerance of each other
        radii = bodies.radii * (1.0 + tolerance)
        super().__init__(
            bodies.positions,
            bodies.velocities,
            radii,
            bodies.masses,
            box.half,
            response,
            restitution,
            record,
            search="cells",
        )
        # The narrow search takes the time, not the memory: no need to keep neighbours together
        self._world = self._world._replace(rules=self._world.rules._replace(tidying=0, burst=BURST[response]))
        order = self._world.spheres.schedule["label"]
        body = solids(form, bodies, order.astype(np.int64), tolerance)
        room = WINDOWS * len(bodies) + 64
        self._solid = SolidWorld(self._world, body, windows(len(bodies), room))

    @property
    def counters(self) -> dict[str, int]:
        """How often what happened; `narrow_tests` are searches of pairs, each of some steps."""
        counts = self._world.tally.counts[0]
        return super().counters | {name: int(counts[name]) for name in SEARCHES}

    def _fly(self, until: float, budget: int) -> int:
        return fly_solids(self._solid, until, budget)

    def _make_room(self) -> None:
        self._solid = self._solid._replace(windows=enlarged(self._solid.windows))
