"""Where the bodies of a run were at any time, from its start and its hits alone.

Between hits paths are straight, and a hit changes velocities by rule, so the list of hits is the whole motion.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel
from harness.motion.response import answer_pairs
from harness.reference.events import Events
from harness.scene.bodies import Bodies
from harness.vocabulary import Response


def positions_at(times: Floats, bodies: Bodies, events: Events, response: Response, restitution: float) -> Floats:
    """Positions at each of `times` (k,), s, in order: (k, n, 3) m.

    Parameters
    ----------
    times : after the start, in order
    bodies : at time 0
    events : of a run with a response (`reflect` or `elastic`)
    response, restitution : that the run had
    """
    positions = np.empty((len(times), len(bodies), 3))
    origins, velocities = bodies.positions.copy(), bodies.velocities.copy()
    plain = events.in_one_layout()
    _replay(times, plain, origins, velocities, bodies.masses, response == "elastic", restitution, positions)
    return positions


@kernel
def _replay(
    times: Floats,
    events: Events,
    origins: Floats,
    velocities: Floats,
    masses: Floats,
    elastic: bool,
    restitution: float,
    positions: Floats,
) -> None:
    """Origins are where each body was at its last hit, at the times `since`; all of it is overwritten."""
    since = np.zeros(len(origins))
    added, changed, hits = np.zeros(4), np.zeros(len(origins), np.bool_), np.zeros(1, np.bool_)
    event = 0
    for k in range(len(times)):
        while event < len(events.times) and events.times[event] <= times[k]:
            now = events.times[event]
            for side in range(2):
                body = events.bodies[event, side]
                if body >= 0:
                    origins[body] += velocities[body] * (now - since[body])
                    since[body] = now
            if events.walls[event] >= 0:
                velocities[events.bodies[event, 0], events.walls[event] // 2] *= -1.0
            else:
                pair = events.bodies[event : event + 1]
                answer_pairs(pair, origins, velocities, masses, elastic, restitution, added, changed, hits)
            event += 1
        for body in range(len(origins)):
            positions[k, body] = origins[body] + velocities[body] * (times[k] - since[body])
