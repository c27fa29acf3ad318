"""Two bodies put by a feature of each: a vertex, an edge or a face of one against that of the other.

A body is turned so that the outward direction of the chosen vertex, edge or face points against that of the other's,
and moved so that the two features are a gap apart along it. Both hulls then lie on their own side of the plane between,
so the gap is exact but for the rounding of the pose, and the judge sees the rounded pose. A negative gap overlaps by
that much at the most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from harness.arrays import Floats
from harness.compare.poses import Pose
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.mesh import Mesh, Surface
from harness.scene.scene import Scene
from harness.vocabulary import Shape

FEATURES = ("vertex", "edge", "face")


class SupportPoint(NamedTuple):
    """A point of a body, m in its own frame, and an outward direction in which no other point of it lies farther."""

    point: Floats
    outward: Floats


def at_contact(
    scene: Scene, away: float, features: tuple[str, str], gaps: Sequence[float], rng: np.random.Generator
) -> Iterator[Pose]:
    """Two bodies by a feature of each, at one gap (of the smaller size) after another along the same normal."""
    sizes = scene.bodies.sizes.tolist()
    contact, other = (contact_of(solid_of(scene, body), sizes[body], name, rng) for body, name in enumerate(features))
    turned = random_turn(rng)
    normal = rotated(turned, contact.outward)
    against = turn_onto(other.outward, -normal, rng.uniform(0, 2 * np.pi))
    centre = away * random_direction(rng)
    for gap in gaps:
        place = centre + rotated(turned, contact.point) + gap * min(sizes) * normal - rotated(against, other.point)
        name = f"{features[0]} to {features[1]}, gap {gap:g}"
        yield Pose(name, np.array([centre, place]), np.array([turned, against]))


def two_bodies(shape: Shape, meshes: tuple[Mesh, ...], sizes: tuple[float, float], away: float) -> Scene:
    """A scene of two bodies of these sizes, m, at rest, in a box that holds them so far (m) from the origin."""
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


def solid_of(scene: Scene, body: int) -> Surface | None:
    """The hull of a body, m; of a mesh too, since its hull is met first. None for a sphere."""
    return None if scene.shape == "sphere" else replace(scene, shape="hull").solid_of_body(body)


def contact_of(solid: Surface | None, size: float, feature: str, rng: np.random.Generator) -> SupportPoint:
    """A random point of a feature of a body, and the outward direction there; without a solid, of a sphere."""
    if solid is None:
        outward = random_direction(rng)
        return SupportPoint(outward * (size / 2), outward)
    if feature == "vertex":
        outward = random_direction(rng)
        return SupportPoint(solid.vertices[(solid.vertices @ outward).argmax()], outward)
    face = int(rng.integers(len(solid.faces)))
    corners = solid.faces[face]
    if feature == "face":
        return SupportPoint(rng.dirichlet(np.ones(3)) @ solid.vertices[corners], face_normal(solid, face))
    start, end = int(corners[0]), int(corners[1])
    both = (solid.faces == start).any(axis=1) & (solid.faces == end).any(axis=1)
    neighbours = np.flatnonzero(both)
    share = rng.uniform(0.1, 0.9)
    point = share * solid.vertices[start] + (1 - share) * solid.vertices[end]
    between = face_normal(solid, int(neighbours[0])) + face_normal(solid, int(neighbours[-1]))
    return SupportPoint(point, between / np.linalg.norm(between))


def face_normal(solid: Surface, face: int) -> Floats:
    """The outward unit normal of a face, (3,)."""
    a, b, c = solid.vertices[solid.faces[face]]
    normal = _cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal), np.float64)


def random_direction(rng: np.random.Generator) -> Floats:
    """A unit vector, (3,), uniform on the sphere."""
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector), np.float64)


def random_turn(rng: np.random.Generator) -> Floats:
    """A unit quaternion, (4,) w x y z, uniform over all rotations."""
    quaternion = rng.normal(size=4)
    return np.asarray(quaternion / np.linalg.norm(quaternion), np.float64)


def turn_onto(start: Floats, end: Floats, twist: float) -> Floats:
    """The turn that takes one direction to another, after a turn by `twist` (rad) about the first."""
    about = np.array([np.cos(twist / 2), *(np.sin(twist / 2) * start)])
    if start @ end > -0.9:
        half = start + end
        half /= np.linalg.norm(half)
        return product_of(np.array([start @ half, *_cross(start, half)]), about)
    # nearly opposite: half a turn about any axis across, then the little that is left
    across = _cross(start, np.eye(3)[np.abs(start).argmin()])
    back = np.array([0.0, *(across / np.linalg.norm(across))])
    return product_of(turn_onto(-start, end, 0.0), product_of(back, about))


def product_of(p: Sequence[float] | Floats, q: Sequence[float] | Floats) -> Floats:
    """The turn q, and then p."""
    a, b = np.asarray(p), np.asarray(q)
    w = a[0] * b[0] - a[1:] @ b[1:]
    return np.array([w, *(a[0] * b[1:] + b[0] * a[1:] + _cross(a[1:], b[1:]))])


def rotated(quaternion: Floats, vector: Floats) -> Floats:
    """A vector turned by a unit quaternion w x y z."""
    across = 2.0 * _cross(quaternion[1:], vector)
    return np.asarray(vector + quaternion[0] * across + _cross(quaternion[1:], across), np.float64)


def _cross(a: Floats, b: Floats) -> Floats:
    """Of two vectors, a tenth of the time of `numpy.cross`."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])
