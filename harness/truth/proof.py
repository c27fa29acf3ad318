"""Proves what is claimed of cases: that nothing touches until the lower bound, and that the bodies touch at the upper.

Nothing is shared with the engine: the axes that keep parts apart are found and checked in numpy, touching triangles in
fractions. Of two surfaces that do not touch one may still hold the other; of hulls, which are solids, that is excluded
at the start, and cannot come to be without a touch.
"""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Ints
from harness.truth.cases import Cases
from harness.truth.flights import Flights
from harness.truth.separation import parts_that_meet, prove_apart
from harness.truth.solids import Solid, Solids
from harness.truth.touch import FlyingBody, spheres_touch, triangles_touch
from harness.truth.vectors import normalised, rotations, turned

WIDEST = 1e-9
"""s, between both bounds."""
# Pairs of triangles that are tried at an instant before it is given up that any of them touches.
_MOST_PAIRS = 200
# Of the size: by how much one hull must reach beyond the other in some direction.
_BEYOND = 1e-9


def prove(cases: Cases, solids: Solids) -> list[str]:
    """What could not be proven of each case; empty text for a case that is proven as a whole."""
    reasons = [_wrong_bounds(cases, place) for place in range(cases.number)]

    def add(rows: Ints, found: list[str]) -> None:
        for place, reason in zip(rows.tolist(), found, strict=True):
            reasons[place] = reasons[place] or reason

    rows = np.array([place for place, reason in enumerate(reasons) if not reason and cases.lower[place] > 0.0], int)
    hindered, _ = apart(cases.some(rows), solids, cases.lower[rows])
    add(rows, hindered)
    rows = np.array([place for place, reason in enumerate(reasons) if not reason and cases.upper[place] < np.inf], int)
    times = cases.upper[rows]
    found = touching(cases.some(rows), solids, times)
    add(
        rows,
        ["" if yes else f"not proven to touch at {time!r} s" for yes, time in zip(found, times.tolist(), strict=True)],
    )
    return reasons


def apart(cases: Cases, solids: Solids, until: Floats) -> tuple[list[str], Floats]:
    """What hinders a proof that nothing touches from 0 to a time (n,) s; and where it came to a halt, (n,) s."""
    first, second = (_without_spin(flights, solids) for flights in (cases.first, cases.second))
    found = prove_apart(solids.parts, first, second, np.zeros(cases.number), until)
    reasons = []
    for place, proven in enumerate(found.proven.tolist()):
        if not proven:
            reasons.append(f"not proven apart at {float(found.unproven[place])!r} s")
        elif not _none_inside(cases, solids, place):
            reasons.append("one hull may hold the other at the start")
        else:
            reasons.append("")
    return reasons, found.unproven


def touching(cases: Cases, solids: Solids, times: Floats) -> list[bool]:
    """Of each case whether its bodies are proven to touch at a time (n,) s."""
    pairs = parts_that_meet(solids.parts, cases.first, cases.second, times)
    return [_touch(cases, solids, place, float(times[place]), pairs[place]) for place in range(cases.number)]


def _touch(cases: Cases, solids: Solids, place: int, time: float, pairs: Ints) -> bool:
    one, other = (flying_body(flights, place) for flights in (cases.first, cases.second))
    solid, other_solid = (solids.all[flights.meshes[place]] for flights in (cases.first, cases.second))
    if solid.shape == "sphere":
        return spheres_touch(one, other, time)
    faces = solids.parts.faces[pairs[:_MOST_PAIRS]].tolist()
    corners = ((_corners(solid, face), _corners(other_solid, other_face)) for face, other_face in faces)
    return triangles_touch(one, other, time, corners)


def flying_body(flights: Flights, place: int) -> FlyingBody:
    """One body of one case."""
    return FlyingBody(
        float(flights.sizes[place]),
        flights.positions[place].tolist(),
        flights.quaternions[place].tolist(),
        flights.velocities[place].tolist(),
        flights.spins[place].tolist(),
    )


def _without_spin(flights: Flights, solids: Solids) -> Flights:
    """The flights with no spin for spheres: turned, they are the same."""
    spheres = np.array([solids.all[mesh].shape == "sphere" for mesh in flights.meshes], bool)
    return flights._replace(spins=np.where(spheres[:, None], 0.0, flights.spins))


def _wrong_bounds(cases: Cases, place: int) -> str:
    window, lower, upper = cases.windows[place], cases.lower[place], cases.upper[place]
    if not all(np.isfinite(column[place]).all() for column in (*cases.first, *cases.second)):
        return "a number is not finite"
    if np.isinf(upper):
        return "" if lower == window > 0.0 else "never is claimed of a part of the window only"
    if not 0.0 <= lower <= upper <= window:
        return "the bounds are not in order, or not in the window"
    if not upper - lower <= WIDEST:
        return f"the bounds are more than {WIDEST:g} s apart"
    return "" if lower < upper or upper == 0.0 else "the bounds are the same"


def _corners(solid: Solid, face: int) -> list[list[float]]:
    corners: list[list[float]] = solid.surface.vertices[solid.surface.faces[face]].tolist()
    return corners


def _none_inside(cases: Cases, solids: Solids, place: int) -> bool:
    """Whether at the start either of two hulls reaches beyond the other in some direction; true of other shapes."""
    flights = (cases.first, cases.second)
    solid = [solids.all[side.meshes[place]] for side in flights]
    if solid[0].shape != "hull":
        return True
    points, normals = [], []
    offset = cases.second.positions[place] - cases.first.positions[place]
    for side, body in zip(flights, solid, strict=True):
        quaternion = normalised(side.quaternions[place])[:, None]
        turn = rotations(quaternion, np.zeros((3, 1)), np.zeros(1))
        points.append(side.sizes[place] * turned(turn, body.surface.vertices.T))
        a, b, c = (body.surface.vertices[body.surface.faces[:, corner]] for corner in range(3))
        normals.append(normalised(turned(turn, np.cross(b - a, c - a).T)))
    points[1] = points[1] + offset[:, None]
    axes = np.concatenate([*normals, normalised(offset)[:, None], -normalised(offset)[:, None]], axis=1).T
    highest, other_highest = ((axes @ some).max(axis=1) for some in points)
    slack = _BEYOND * float(max(np.abs(some).max() for some in points))
    return bool((highest > other_highest + slack).any() and (other_highest > highest + slack).any())
