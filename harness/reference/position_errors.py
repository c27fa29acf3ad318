"""How far the bodies of a run with response are off, up to the first hit that differs from the reference.

Chaos makes of the smallest difference another motion, and the reference is rounded too. How long it holds is shown by
its twin: the same motion in another unit of length, in which every number is rounded otherwise.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from harness.motion.hits import Trace
from harness.reference.divergence import first_divergence
from harness.reference.events import Events
from harness.reference.positions_from_hits import positions_at
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.scene import Scene
from harness.vocabulary import Response

# Times at which the positions of two motions are compared, and positions that may be held for it in all.
MOST_TIMES, MOST_POSITIONS = 256, 2**21
# The other unit of length; no power of two, so that every number is rounded otherwise.
UNIT = math.pi / 3.0


class ReferenceEvents(NamedTuple):
    """The events of the reference, and of its twin."""

    exact: Events
    twin: Events


def in_another_unit(scene: Scene) -> Scene:
    """The scene of the twin: all lengths in another unit."""
    bodies = scene.bodies
    return replace(
        scene,
        bodies=replace(
            bodies, positions=bodies.positions * UNIT, velocities=bodies.velocities * UNIT, sizes=bodies.sizes * UNIT
        ),
        box=Box(scene.box.half * UNIT),
    )


def position_errors(
    bodies: Bodies, flown: Trace, reference: ReferenceEvents, duration: float, response: Response, restitution: float
) -> dict[str, float]:
    """The metrics that a run's motion is judged by.

    Parameters
    ----------
    bodies : at time 0
    flown : the run
    reference : its events and its twin's
    duration : s, of both
    response, restitution : of both

    Returns
    -------
    dict
        `divergence_time` (s) and, of the twin, `reference_divergence_time`; `position_error` (m) before either, and
        `reference_position_error`.
    """
    run, exact, twin = Events.of(flown), reference.exact, reference.twin
    metrics = {
        "divergence_time": min(duration, first_divergence(len(bodies), run, exact)),
        "reference_divergence_time": min(duration, first_divergence(len(bodies), twin, exact)),
    }
    count = min(MOST_TIMES, MOST_POSITIONS // max(1, len(bodies)))
    times = duration * np.arange(1, count + 1) / count
    times = times[(times < min(metrics.values())) & (times <= flown.time)]
    if len(times) and len(bodies):
        ours, theirs, again = (
            positions_at(times, bodies, events, response, restitution) for events in (run, exact, twin)
        )
        metrics["position_error"] = float(np.linalg.norm(ours - theirs, axis=2).max())
        metrics["reference_position_error"] = float(np.linalg.norm(again - theirs, axis=2).max())
    return metrics
