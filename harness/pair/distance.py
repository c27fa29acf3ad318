"""Whether two bodies touch, and how far apart they are and where, for one pair of poses or for many."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Flags, Floats
from harness.narrowphase.gap import EXACT, TOUCHING, Accuracy
from harness.narrowphase.pose_gaps import Gaps, Poses, hull_gaps, mesh_gaps, sphere_gaps
from harness.pair.body import Body, pose_count, rows, searchable


class Distance(NamedTuple):
    """How far two bodies are apart.

    Attributes
    ----------
    gap : float, or (n,) array, m; 0 where they touch
    points : (2, 3) or (n, 2, 3) float array, m, in the world: the nearest points of the first and the second body;
        twice the same, of both, where they touch
    """

    gap: float | Floats
    points: Floats


def touching(a: Body, b: Body) -> bool | Flags:
    """Whether two bodies touch; documented as `harness.touching`."""
    count = pose_count(a, b)
    found = _gaps(a, b, Accuracy(TOUCHING * (a.size + b.size), 0.0, 0.0)).gaps == 0.0
    return bool(found[0]) if count is None else found


def distance(a: Body, b: Body) -> Distance:
    """How far two bodies are apart; documented as `harness.distance`."""
    count = pose_count(a, b)
    found = _gaps(a, b, EXACT)
    return Distance(float(found.gaps[0]), found.points[0]) if count is None else Distance(*found)


def _gaps(a: Body, b: Body, accuracy: Accuracy) -> Gaps:
    count = pose_count(a, b)
    one, other = (Poses(rows(body.position, count), rows(body.quaternion, count), body.size) for body in (a, b))
    found = Gaps(np.empty(len(one.positions)), np.empty((len(one.positions), 2, 3)))
    if a.shape == "sphere":
        sphere_gaps(one, other, accuracy, found)
    elif a.shape == "hull":
        hull_gaps(searchable(a).mesh.hull, searchable(b).mesh.hull, one, other, accuracy, found)
    else:
        mesh_gaps(searchable(a), searchable(b), one, other, accuracy, found)
    return found
