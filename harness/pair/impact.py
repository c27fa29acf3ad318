"""When two bodies in free flight first touch, for one pair of motions or for many."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.errors import InputError
from harness.narrowphase.motion_impacts import Motions, Window, hull_impacts, mesh_impacts, sphere_impacts
from harness.narrowphase.pose_gaps import Poses
from harness.pair.body import Body, pose_count, rows, searchable


def time_of_impact(a: Body, b: Body, until: float, tolerance: float = 1e-9) -> float | Floats:
    """When two bodies touch; documented as `harness.time_of_impact`."""
    count = pose_count(a, b)
    if not until >= 0.0:
        raise InputError(f"until is {until}; it must be a time of 0 s or later")
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"tolerance is {tolerance}; it must be above 0 and below 1")
    window = Window(float(until), tolerance * (a.size + b.size) / 2.0)
    one, other = _motions(a, count), _motions(b, count)
    times = np.empty(len(one.velocities))
    if a.shape == "sphere":
        sphere_impacts(one, other, window, times)
    elif a.shape == "hull":
        hull_impacts(searchable(a).mesh.hull, searchable(b).mesh.hull, one, other, window, times)
    else:
        mesh_impacts(searchable(a).mesh, searchable(b).mesh, one, other, window, times)
    return float(times[0]) if count is None else times


def _motions(body: Body, count: int | None) -> Motions:
    start = Poses(rows(body.position, count), rows(body.quaternion, count), body.size)
    radius = 0.5 if body.shape == "sphere" else searchable(body).mesh.radius
    return Motions(start, rows(body.velocity, count), rows(body.spin, count), body.size * radius)
