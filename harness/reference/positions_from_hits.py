"""Where the bodies of a run were at any time, from its start and its hits alone.

Between hits paths are straight, and a hit changes velocities by rule, so the list of hits is the whole motion.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.kernel import kernel
from harness.motion.hits import Trace
from harness.motion.response import answer_pairs
from harness.scene.bodies import Bodies
from harness.vocabulary import Response


def positions_at(times: Floats, bodies: Bodies, trace: Trace, response: Response, restitution: float) -> Floats:
    """Positions at each of `times` (k,), s, in order: (k, n, 3) m.

    Parameters
    ----------
    times : after the start, in order
    bodies : at time 0
    trace : of a run with a response (`reflect` or `elastic`)
    response, restitution : that the run had
    """
    positions = np.empty((len(times), len(bodies), 3))
    _play(
        times, trace.times, trace.bodies, trace.walls, bodies.positions.copy(), bodies.velocities.copy(), bodies.masses,
        response == "elastic", restitution, positions,
    )  # fmt: skip
    return positions


@kernel
def _play(
    times: Floats,
    when: Floats,
    pairs: Pairs,
    walls: Ints,
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
        while event < len(when) and when[event] <= times[k]:
            for side in range(2):
                body = pairs[event, side]
                if body >= 0:
                    origins[body] += velocities[body] * (when[event] - since[body])
                    since[body] = when[event]
            if walls[event] >= 0:
                velocities[pairs[event, 0], walls[event] // 2] *= -1.0
            else:
                answer_pairs(
                    pairs[event : event + 1], origins, velocities, masses, elastic, restitution, added, changed, hits
                )
            event += 1
        for body in range(len(origins)):
            positions[k, body] = origins[body] + velocities[body] * (times[k] - since[body])
