"""Poses made hard on purpose: two bodies at first contact by a given feature of each, a given gap apart.

A body is turned so that the outward direction of the chosen vertex, edge or face points against that of the other's,
and moved so that the two features are a gap apart along it. Both hulls then lie on their own side of the plane between,
so the gap is exact but for the rounding of the pose, and the judge sees the rounded pose. A negative gap overlaps by
that much at the most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.compare.poses import Pose, PoseSet
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.mesh import Mesh, Surface
from harness.scene.scene import Scene
from harness.vocabulary import Shape

GAPS = (0.0, *(sign * 10.0**power for power in range(-15, -1) for sign in (1, -1)))
"""Of the size of the smaller body."""

_FEATURES = ("vertex", "edge", "face")
# The sizes of the two bodies and how far from the origin they are, m: ratios up to the 10^4 that scenes have.
_SIZES_AND_DISTANCES = (
    (1.0, 1.0, 0.0),
    (1.0, 1.0, 1e3),
    (1.0, 1.0, 1e6),
    (1e-3, 1e-3, 0.0),
    (1e3, 1e3, 0.0),
    (1e3, 1e3, 1e6),
    (1.0, 0.3, 0.0),
    (10.0, 1.0, 10.0),
    (50.0, 1.0, 0.0),
    (1.0, 2000.0, 0.0),
    (1e4, 1.0, 0.0),
)
_THINNED = 4
"""Of hulls and meshes of other sizes, and far away, every n-th first contact: all of them take long to judge."""
_STEPS = (4e-7, -4e-7, 3e-8, -3e-8, 2e-9, -2e-9)
"""Gaps, of the size of the smaller body, that follow each other at one contact: poses nearer together than 1e-6."""
_SEED = 259


class _Contact(NamedTuple):
    """A point of a body, m in its own frame, and an outward direction in which no other point of it lies farther."""

    point: Floats
    outward: Floats


def hard_poses(shape: Shape, meshes: tuple[Mesh, ...], every: int = 1) -> Iterator[PoseSet]:
    """Pairs at first contact, deep inside each other, contained and concentric, of many sizes and far away.

    Parameters
    ----------
    shape : what the narrow phase is to see
    meshes : of the first body and of the second, or of both
    every : of the first contacts, take every n-th
    """
    for number, (size, other, away) in enumerate(_SIZES_AND_DISTANCES):
        some = every if number == 0 or shape == "sphere" else max(every, _THINNED)
        yield PoseSet(_two(shape, meshes, (size, other), away), partial(_poses, away=away, every=some), hard=True)


def _poses(scene: Scene, away: float, every: int) -> tuple[Pose, ...]:
    first, second = scene.bodies.sizes.tolist()
    return (
        *_first_contacts(scene, away, every),
        *_small_steps(scene, away, every),
        *_overlaps((first, second), away),
    )


def _first_contacts(scene: Scene, away: float, every: int) -> Iterator[Pose]:
    for number, (features, gap) in enumerate(product(_features(scene), GAPS)):
        if number % every == 0:
            yield from _at_contact(scene, away, features, (gap,), np.random.default_rng((_SEED, number)))


def _small_steps(scene: Scene, away: float, every: int) -> Iterator[Pose]:
    for number, features in enumerate(_features(scene)):
        if number % min(every, len(_FEATURES)) == 0:
            yield from _at_contact(scene, away, features, _STEPS, np.random.default_rng((_SEED, number, 1)))


def _features(scene: Scene) -> list[tuple[str, str]]:
    names = ("surface",) if scene.shape == "sphere" else _FEATURES
    return list(product(names, names))


def _at_contact(
    scene: Scene, away: float, features: tuple[str, str], gaps: Sequence[float], rng: np.random.Generator
) -> Iterator[Pose]:
    """Two bodies by a feature of each, at one gap (of the smaller size) after another along the same normal."""
    sizes = scene.bodies.sizes.tolist()
    contact, other = (_contact(_solid(scene, body), sizes[body], name, rng) for body, name in enumerate(features))
    turned = _random_turn(rng)
    normal = _rotated(turned, contact.outward)
    against = _turn_onto(other.outward, -normal, rng.uniform(0, 2 * np.pi))
    centre = away * _direction(rng)
    for gap in gaps:
        place = centre + _rotated(turned, contact.point) + gap * min(sizes) * normal - _rotated(against, other.point)
        name = f"{features[0]} to {features[1]}, gap {gap:g}"
        yield Pose(name, np.array([centre, place]), np.array([turned, against]))


def _overlaps(sizes: tuple[float, float], away: float) -> Iterator[Pose]:
    """Centres from concentric to half of what would part the bounding spheres: deep overlap or containment."""
    rng = np.random.default_rng(_SEED)
    for share in (0.0, 1e-12, 1e-3, 0.03, 0.1, 0.2, 0.3, 0.5):
        centre = away * _direction(rng)
        place = centre + share * (sizes[0] + sizes[1]) / 2 * _direction(rng)
        turns = np.array([_random_turn(rng), _random_turn(rng)])
        yield Pose(f"centres {share:g} of the reach apart", np.array([centre, place]), turns)


def _two(shape: Shape, meshes: tuple[Mesh, ...], sizes: tuple[float, float], away: float) -> Scene:
    bodies = Bodies(
        positions=np.zeros((2, 3)),
        velocities=np.zeros((2, 3)),
        quaternions=np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)),
        spins=np.zeros((2, 3)),
        sizes=np.array(sizes),
        masses=np.array(sizes) ** 3,
    )
    return Scene(
        shape,
        meshes,
        bodies,
        Box(np.full(3, away + 4 * sum(sizes))),
        mesh_of=np.array([0, max(0, len(meshes) - 1)]),
    )


def _solid(scene: Scene, body: int) -> Surface | None:
    """The hull of a body, m; of a mesh too, since its hull is met first. None for a sphere."""
    return None if scene.shape == "sphere" else replace(scene, shape="hull").solid_of_body(body)


def _contact(solid: Surface | None, size: float, feature: str, rng: np.random.Generator) -> _Contact:
    if solid is None:
        outward = _direction(rng)
        return _Contact(outward * (size / 2), outward)
    if feature == "vertex":
        outward = _direction(rng)
        return _Contact(solid.vertices[(solid.vertices @ outward).argmax()], outward)
    face = int(rng.integers(len(solid.faces)))
    corners = solid.faces[face]
    if feature == "face":
        return _Contact(rng.dirichlet(np.ones(3)) @ solid.vertices[corners], _normal(solid, face))
    start, end = int(corners[0]), int(corners[1])
    both = (solid.faces == start).any(axis=1) & (solid.faces == end).any(axis=1)
    neighbours = np.flatnonzero(both)
    share = rng.uniform(0.1, 0.9)
    point = share * solid.vertices[start] + (1 - share) * solid.vertices[end]
    between = _normal(solid, int(neighbours[0])) + _normal(solid, int(neighbours[-1]))
    return _Contact(point, between / np.linalg.norm(between))


def _normal(solid: Surface, face: int) -> Floats:
    a, b, c = solid.vertices[solid.faces[face]]
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
