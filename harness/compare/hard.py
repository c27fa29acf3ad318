"""Poses made hard on purpose: two bodies at first contact by a given feature of each, a given gap apart.

A body is turned so that the outward direction of the chosen vertex, edge or face points against that of the other's,
and moved so that the two features are a gap apart along it. Both hulls then lie on their own side of the plane between,
so the gap is exact but for the rounding of the pose, and the judge sees the rounded pose. A negative gap overlaps by
that much at the most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.compare.poses import Pose, PoseSet
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import Hull
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene, Shape

GAPS = (0.0, *(sign * 10.0**power for power in range(-15, -1) for sign in (1, -1)))
"""Of the size of the smaller body."""

_FEATURES = ("vertex", "edge", "face")
# sizes of the two bodies and how far from the origin they are, m
_SETTINGS = (
    (1.0, 1.0, 0.0),
    (1.0, 1.0, 1e3),
    (1.0, 1.0, 1e6),
    (1e-3, 1e-3, 0.0),
    (1e3, 1e3, 0.0),
    (1e3, 1e3, 1e6),
    (1.0, 0.3, 0.0),
    (10.0, 1.0, 10.0),
)
_SEED = 259


class _Contact(NamedTuple):
    """A point of a hull of size 1 and an outward direction in which no other point of it lies farther."""

    point: Floats
    outward: Floats


def hard_poses(shape: Shape, mesh: Mesh | None) -> Iterator[PoseSet]:
    """Pairs at first contact, deep inside each other, contained and concentric, of many sizes and far away.

    Parameters
    ----------
    shape : what the narrow phase is to see
    mesh : None for spheres
    """
    rng = np.random.default_rng(_SEED)
    for size, other, away in _SETTINGS:
        poses = [*_first_contacts(shape, mesh, (size, other), away, rng), *_overlaps((size, other), away, rng)]
        yield PoseSet(_two(shape, mesh, (size, other), poses[0]), tuple(poses))


def _first_contacts(
    shape: Shape, mesh: Mesh | None, sizes: tuple[float, float], away: float, rng: np.random.Generator
) -> Iterator[Pose]:
    names = ("surface",) if shape == "sphere" or mesh is None else _FEATURES
    for (first, second), gap in product(product(names, names), GAPS):
        contacts = [_contact(mesh, name, rng) for name in (first, second)]
        turned = _random_turn(rng)
        normal = _rotated(turned, contacts[0].outward)
        against = _turn_onto(contacts[1].outward, -normal, rng.uniform(0, 2 * np.pi))
        centre = away * _direction(rng)
        place = centre + _rotated(turned, contacts[0].point) * sizes[0]
        place = place + gap * min(sizes) * normal - _rotated(against, contacts[1].point) * sizes[1]
        yield Pose(f"{first} to {second}, gap {gap:g}", np.array([centre, place]), np.array([turned, against]))


def _overlaps(sizes: tuple[float, float], away: float, rng: np.random.Generator) -> Iterator[Pose]:
    """Centres from concentric to half of what would part the bounding spheres: deep overlap or containment."""
    for share in (0.0, 1e-12, 1e-3, 0.03, 0.1, 0.2, 0.3, 0.5):
        centre = away * _direction(rng)
        place = centre + share * (sizes[0] + sizes[1]) / 2 * _direction(rng)
        turns = np.array([_random_turn(rng), _random_turn(rng)])
        yield Pose(f"centres {share:g} of the reach apart", np.array([centre, place]), turns)


def _two(shape: Shape, mesh: Mesh | None, sizes: tuple[float, float], pose: Pose) -> Scene:
    bodies = Bodies(
        positions=pose.positions,
        velocities=np.zeros((2, 3)),
        quaternions=pose.quaternions,
        spins=np.zeros((2, 3)),
        sizes=np.array(sizes),
        masses=np.array(sizes) ** 3,
    )
    half = float(np.abs(pose.positions).max()) + 4 * sum(sizes)
    return Scene(shape, mesh, bodies, Box(np.full(3, half)))


def _contact(mesh: Mesh | None, feature: str, rng: np.random.Generator) -> _Contact:
    if mesh is None or feature == "surface":
        outward = _direction(rng)
        return _Contact(outward / 2, outward)
    hull = mesh.hull
    if feature == "vertex":
        outward = _direction(rng)
        return _Contact(hull.vertices[(hull.vertices @ outward).argmax()], outward)
    face = int(rng.integers(len(hull.faces)))
    corners = hull.faces[face]
    if feature == "face":
        return _Contact(rng.dirichlet(np.ones(3)) @ hull.vertices[corners], _normal(hull, face))
    start, end = int(corners[0]), int(corners[1])
    across = next(
        other for other, their in enumerate(hull.faces.tolist()) if other != face and start in their and end in their
    )
    share = rng.uniform(0.1, 0.9)
    point = share * hull.vertices[start] + (1 - share) * hull.vertices[end]
    between = _normal(hull, face) + _normal(hull, across)
    return _Contact(point, between / np.linalg.norm(between))


def _normal(hull: Hull, face: int) -> Floats:
    a, b, c = hull.vertices[hull.faces[face]]
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal), np.float64)


def _direction(rng: np.random.Generator) -> Floats:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector), np.float64)


def _random_turn(rng: np.random.Generator) -> Floats:
    quaternion = rng.normal(size=4)
    return np.asarray(quaternion / np.linalg.norm(quaternion), np.float64)


def _turn_onto(start: Floats, end: Floats, twist: float) -> Floats:
    """The turn that takes one direction to another, after a turn by `twist` (rad) about the first."""
    about = np.array([np.cos(twist / 2), *(np.sin(twist / 2) * start)])
    if start @ end > -0.9:
        half = start + end
        half /= np.linalg.norm(half)
        return _product(np.array([start @ half, *np.cross(start, half)]), about)
    # nearly opposite: half a turn about any axis across, then the little that is left
    across = np.cross(start, np.eye(3)[np.abs(start).argmin()])
    back = np.array([0.0, *(across / np.linalg.norm(across))])
    return _product(_turn_onto(-start, end, 0.0), _product(back, about))


def _product(p: Sequence[float] | Floats, q: Sequence[float] | Floats) -> Floats:
    a, b = np.asarray(p), np.asarray(q)
    w = a[0] * b[0] - a[1:] @ b[1:]
    return np.array([w, *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def _rotated(quaternion: Floats, vector: Floats) -> Floats:
    across = 2.0 * np.cross(quaternion[1:], vector)
    return np.asarray(vector + quaternion[0] * across + np.cross(quaternion[1:], across), np.float64)
