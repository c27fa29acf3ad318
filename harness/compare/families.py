"""Families of poses of two bodies: each puts them where backends go wrong in a way of its own.

What a family is stands in `harness.vocabulary.FAMILIES`. Poses are drawn from a seed, so that the same file asks the
same questions, and the judge sees them as they are rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from harness.arrays import Floats
from harness.backends.close_spheres import close_pairs
from harness.compare.placing import (
    FEATURES,
    at_contact,
    face_normal,
    product_of,
    random_direction,
    random_turn,
    rotated,
    solid_of,
    turn_onto,
    two_bodies,
)
from harness.compare.poses import Pose, PoseSet
from harness.scene.ignored_pairs import without
from harness.scene.mesh import Mesh, Surface
from harness.scene.scene import Scene
from harness.vocabulary import Shape

_SEED = 259
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])

Draw = Callable[[Scene, float, np.random.Generator], Pose]
"""A pose of a scene of two bodies, so far (m) from the origin."""


def family_poses(family: str, shape: Shape, meshes: tuple[Mesh, ...], count: int) -> Iterator[PoseSet]:
    """The poses of a family, as many as said, shared among the sizes and places that it has."""
    variants, draw = _FAMILIES[family]
    for number, (sizes, away) in enumerate(variants):
        some = count // len(variants) + (number < count % len(variants))
        scene = two_bodies(shape, meshes, sizes, away)
        yield PoseSet(scene, partial(_drawn, draw=draw, away=away, seed=(_SEED, number), count=some), hard=True)


def resting_poses(scene: Scene, count: int) -> Iterator[PoseSet]:
    """Bodies of a scene with recorded poses whose bounding spheres touch, two by two, as many as said at the most.

    They are taken from all frames alike, and those of bodies of the same meshes and sizes are asked together.

    Parameters
    ----------
    scene : whose poses were recorded
    count : poses at the most
    """
    recorded = scene.poses
    assert recorded is not None, "the family resting is of recorded poses"
    near = [
        (frame, i, j)
        for frame, places in enumerate(recorded.positions)
        for i, j in without(close_pairs(places, scene.bodies.radii), scene.ignored).tolist()
    ]
    chosen = near if len(near) <= count else [near[place * len(near) // count] for place in range(count)]
    alike: dict[tuple[float, ...], list[tuple[int, int, int]]] = {}
    for frame, i, j in chosen:
        kind = (*scene.mesh_of[[i, j]].tolist(), *scene.bodies.sizes[[i, j]].tolist())
        alike.setdefault(kind, []).append((frame, i, j))
    for some in alike.values():
        _, i, j = some[0]
        meshes = tuple(scene.meshes[mesh] for mesh in scene.mesh_of[[i, j]]) if scene.meshes else ()
        sizes = float(scene.bodies.sizes[i]), float(scene.bodies.sizes[j])
        away = float(np.abs(recorded.positions).max())
        two = two_bodies(scene.shape, meshes if meshes[:1] != meshes[1:] else meshes[:1], sizes, away)
        poses = tuple(
            Pose(
                f"bodies {i} and {j} at {recorded.time[frame]:.6g} s",
                np.ascontiguousarray(recorded.positions[frame, [i, j]]),
                np.ascontiguousarray(recorded.quaternions[frame, [i, j]]),
            )
            for frame, i, j in some
        )
        yield PoseSet(two, partial(_as_they_are, poses), hard=True)


def _as_they_are(poses: tuple[Pose, ...], held: Scene) -> tuple[Pose, ...]:
    return poses


def _drawn(scene: Scene, draw: Draw, away: float, seed: tuple[int, int], count: int) -> tuple[Pose, ...]:
    return tuple(draw(scene, away, np.random.default_rng((*seed, place))) for place in range(count))


def _apart(scene: Scene, away: float, rng: np.random.Generator, share: float) -> Pose:
    """Centres at a share of what parts the bounding spheres, turned at random."""
    reach = float(scene.bodies.radii.sum())
    centre = away * random_direction(rng)
    places = np.array([centre, centre + share * reach * random_direction(rng)])
    return Pose(f"centres {share:.3g} of the reach apart", places, np.array([random_turn(rng), random_turn(rng)]))


def _random(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    return _apart(scene, away, rng, rng.uniform(0.3, 1.02))


def _deep(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    return _apart(scene, away, rng, rng.uniform(0.0, 0.3))


def _contained(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    return _apart(scene, away, rng, rng.uniform(0.0, 0.05))


def _grazing(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    names = ("surface",) if scene.shape == "sphere" else FEATURES
    features = str(rng.choice(names)), str(rng.choice(names))
    gap = float(rng.choice([-1.0, 1.0]) * 10.0 ** int(rng.integers(-15, -1))) if rng.random() < 0.95 else 0.0
    (pose,) = at_contact(scene, away, features, (gap,), rng)
    return pose


def _aligned(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    """The second body lies along a direction of the first, turned as it is or with the same feature against it."""
    feature = str(rng.choice(FEATURES))
    first, second = (_direction_of(solid_of(scene, body), feature, rng) for body in (0, 1))
    turned = _UPRIGHT if rng.random() < 0.5 else random_turn(rng)
    along = rotated(turned, first)
    against = turned if rng.random() < 0.5 else turn_onto(second, -along, 0.0)
    tilt = 0.0 if rng.random() < 0.4 else 10.0 ** rng.integers(-9, -2)
    about = random_direction(rng)
    against = product_of([np.cos(tilt / 2), *(np.sin(tilt / 2) * about)], against)
    width = _reach(scene, 0, turned, along) + _reach(scene, 1, against, -along)
    share = rng.uniform(0.0, 1.05)
    name = f"along a {feature} direction, {tilt:g} rad off, {share:.3g} of the width apart"
    return Pose(name, np.array([np.zeros(3), share * width * along]), np.array([turned, against]))


def _direction_of(solid: Surface | None, feature: str, rng: np.random.Generator) -> Floats:
    """From the centre to a vertex, along an edge, or across a face."""
    if solid is None:
        return random_direction(rng)
    face = int(rng.integers(len(solid.faces)))
    start, end, _ = solid.vertices[solid.faces[face]]
    if feature == "face":
        return face_normal(solid, face)
    way = start if feature == "vertex" else end - start
    return np.asarray(way / np.linalg.norm(way), np.float64)


def _shared(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    """Both turned alike, so that a feature of one lies in one of the other without any rounding of a turn."""
    sizes = scene.bodies.sizes.tolist()
    solids = [solid_of(scene, body) for body in (0, 1)]
    kind = str(rng.choice(["all", "vertex", "edge", "plane"]))
    turned = _UPRIGHT if rng.random() < 0.7 else random_turn(rng)
    if solids[0] is None or solids[1] is None:
        offset = random_direction(rng) * (0.0 if kind == "all" else sum(sizes) / 2)
    elif kind == "all":
        offset = np.zeros(3)
    else:
        one, other = solids[0].vertices, solids[1].vertices
        a, b = one[rng.integers(len(one))], other[rng.integers(len(other))]
        offset = a - b
        face = solids[0].faces[rng.integers(len(solids[0].faces))]
        if kind == "edge":
            offset = offset + rng.uniform() * (one[face[1]] - one[face[0]])
        elif kind == "plane":
            first, second = rng.uniform(-1.0, 1.0, 2)
            offset = offset + first * (one[face[1]] - one[face[0]]) + second * (one[face[2]] - one[face[0]])
    places = np.array([np.zeros(3), rotated(turned, np.asarray(offset))])
    return Pose(f"{'a ' if kind != 'all' else ''}{kind} in common", places, np.array([turned, turned]))


def _either(scene: Scene, away: float, rng: np.random.Generator) -> Pose:
    return (_random if rng.random() < 0.5 else _grazing)(scene, away, rng)


def _reach(scene: Scene, body: int, turned: Floats, along: Floats) -> float:
    """m, how far a body extends along a direction."""
    size = float(scene.bodies.sizes[body])
    solid = solid_of(scene, body)
    if solid is None:
        return size / 2
    return float((solid.vertices @ rotated(turned * [1, -1, -1, -1], along)).max())


Variants = tuple[tuple[tuple[float, float], float], ...]
"""((sizes of both, m), m from the origin)."""

_EQUAL: Variants = (((1.0, 1.0), 0.0),)
_FAMILIES: dict[str, tuple[Variants, Draw]] = {
    "random": (_EQUAL, _random),
    "aligned": ((((1.0, 1.0), 0.0), ((1.0, 0.6), 0.0)), _aligned),
    "grazing": (_EQUAL, _grazing),
    "deep": (_EQUAL, _deep),
    "contained": ((((1.0, 0.2), 0.0), ((1.0, 0.05), 0.0)), _contained),
    "shared": ((((1.0, 1.0), 0.0), ((1.0, 0.5), 0.0)), _shared),
    "sizes": (tuple(((10.0**power, 1.0), 0.0) for power in (1, 2, 3, 4)), _grazing),
    "far": ((((1.0, 1.0), 1e3), ((1.0, 1.0), 1e6)), _grazing),
    "units": ((((1e-4, 1e-4), 0.0), ((1e4, 1e4), 0.0)), _either),
}
