"""Bodies of any shape in a reflecting box, flown from event to event."""

from __future__ import annotations

import numpy as np

from harness.arrays import Pairs
from harness.motion.predictive.codes import Stop
from harness.motion.predictive.simulation import Simulation
from harness.motion.predictive.solid_flight import fly_solids
from harness.motion.predictive.solids import Form, SolidWorld, solids
from harness.motion.predictive.windows import empty_windows, enlarged
from harness.scene.bodies import Bodies
from harness.scene.box import Box

# Windows that a body has room for at first.
WINDOWS = 6
# Hits that a collision burst may have: fewer than of spheres, as each costs the searches of all that overlap.
BURST_LIMIT = {"none": 30, "reflect": 1000, "elastic": 10_000}


class SolidSimulation(Simulation):
    """Motion of spinning hulls or meshes, each contact found to a tolerance.

    Parameters
    ----------
    bodies : Bodies
    box : Box
    form : Form of the bodies
    response, restitution, record, states, ignored : as of `Simulation`
    tolerance : gap, relative to the mean size of two bodies, at which surfaces count as touching
    """

    # narrow tests are searches of pairs, each of some steps
    COUNTERS = (*Simulation.COUNTERS, "narrow_tests", "box_tests", "advancement_steps")

    def __init__(
        self,
        bodies: Bodies,
        box: Box,
        form: Form,
        response: str = "reflect",
        restitution: float = 1.0,
        *,
        record: bool = False,
        states: bool = False,
        tolerance: float = 1e-6,
        ignored: Pairs | None = None,
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
            record=record,
            states=states,
            search="cells",
            ignored=ignored,
        )
        # The narrow search takes the time, not the memory: there is no need to keep neighbours together
        self._world = self._world._replace(
            rules=self._world.rules._replace(bases_per_order=0, burst_limit=BURST_LIMIT[response])
        )
        order = self._world.spheres.schedule["label"]
        body = solids(form, bodies, order.astype(np.int64), tolerance)
        capacity = WINDOWS * len(bodies) + 64
        self._solid = SolidWorld(self._world, body, empty_windows(len(bodies), capacity))

    def _fly(self, until: float, budget: int) -> Stop:
        return fly_solids(self._solid, until, budget)

    def _make_room(self) -> None:
        self._solid = self._solid._replace(windows=enlarged(self._solid.windows))
