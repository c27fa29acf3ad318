"""Poses made hard on purpose: two bodies at first contact by a given feature of each, a given gap apart."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product

import numpy as np

from harness.compare.placing import FEATURES, at_contact, random_direction, random_turn, two_bodies
from harness.compare.poses import Pose, PoseSet
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.vocabulary import Shape

GAPS = (0.0, *(sign * 10.0**power for power in range(-15, -1) for sign in (1, -1)))
"""Of the size of the smaller body."""

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
        yield PoseSet(two_bodies(shape, meshes, (size, other), away), partial(_poses, away=away, every=some), hard=True)


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
            yield from at_contact(scene, away, features, (gap,), np.random.default_rng((_SEED, number)))


def _small_steps(scene: Scene, away: float, every: int) -> Iterator[Pose]:
    for number, features in enumerate(_features(scene)):
        if number % min(every, len(FEATURES)) == 0:
            yield from at_contact(scene, away, features, _STEPS, np.random.default_rng((_SEED, number, 1)))


def _features(scene: Scene) -> list[tuple[str, str]]:
    names = ("surface",) if scene.shape == "sphere" else FEATURES
    return list(product(names, names))


def _overlaps(sizes: tuple[float, float], away: float) -> Iterator[Pose]:
    """Centres from concentric to half of what would part the bounding spheres: deep overlap or containment."""
    rng = np.random.default_rng(_SEED)
    for share in (0.0, 1e-12, 1e-3, 0.03, 0.1, 0.2, 0.3, 0.5):
        centre = away * random_direction(rng)
        place = centre + share * (sizes[0] + sizes[1]) / 2 * random_direction(rng)
        turns = np.array([random_turn(rng), random_turn(rng)])
        yield Pose(f"centres {share:g} of the reach apart", np.array([centre, place]), turns)
