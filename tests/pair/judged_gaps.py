"""Gaps, nearest points and touching of random and degenerate pairs, held against the exact judge.

    python -m tests.pair.judged_gaps COUNT [SEED]

tells how many of so many pairs are wrong, and the largest error of a gap.
"""

import sys
from typing import NamedTuple

import numpy as np
import trimesh

import harness
from harness.compare.exact import PlacedPoints
from harness.compare.exact_distance import hull_distance, surface_distance
from tests.narrowphase.meshes import turns

# Of a size, and of the gap: how far a gap may be off.
OF_SIZE, OF_GAP = 1e-12, 2e-15

FORMS = ("cube", "needle", "flat", "star")
GAPS = (0.0, 1e-12, 1e-6, 1e-2, 1.0, 1e8)
RATIOS = (0, 0, 1, 3)
FAR = (0.0, 1e6, 1e8)


class Case(NamedTuple):
    """Two bodies: their shape and forms, about how far they are apart, the power of ten of their sizes' ratio, and how
    large coordinates are."""

    shape: str
    forms: tuple[str, str]
    gap: float
    ratio: int
    far: float


class Judged(NamedTuple):
    """What was found of a case: by how much its gap is off, beyond rounding, of the larger size; and what is wrong."""

    error: float
    wrong: str


def random_case(rng):
    forms = tuple(rng.choice(FORMS, 2).tolist())
    return Case(rng.choice(["hull", "mesh"]), forms, rng.choice(GAPS), rng.choice(RATIOS), rng.choice(FAR))


def solid(rng, form):
    """A mesh of few faces."""
    if form == "star":  # a concave one
        box = trimesh.creation.icosphere(subdivisions=1)
        return trimesh.Trimesh(box.vertices * rng.uniform(0.4, 1.0, (len(box.vertices), 1)), box.faces, process=False)
    stretch = {"cube": [1, 1, 1], "needle": [1, 1e-6, 1e-6], "flat": [1, 1, 1e-7]}[form]
    box = trimesh.creation.box()
    return trimesh.Trimesh(box.vertices * stretch, box.faces, process=False)


def placed_at(rng, gap, ratio, far):
    """Two poses whose bounding spheres are about a gap apart, at coordinates of a given size."""
    sizes = 1.0, 10.0**ratio
    way = rng.normal(size=3) if rng.random() < 0.6 else np.eye(3)[rng.integers(3)]
    start = far * rng.normal(size=3)
    end = start + way / np.linalg.norm(way) * (sum(sizes) / 2 * rng.uniform(0.3, 1.2) + gap)
    q = turns(rng, 2)
    if rng.random() < 0.4:
        q[1] = q[0] = [1, 0, 0, 0]
    return sizes, (start, end), q


def certified(a, b):
    """The certificate of the distance of two bodies, checked."""
    (first, parts), (second, others) = _parts(a), _parts(b)
    truth = hull_distance(first, second) if a.shape == "hull" else surface_distance(first, parts, second, others)
    truth.check(first, parts, second, others)
    return truth


def _parts(body):
    """Vertices in m at the pose of a body, and its convex parts."""
    solid = body.mesh.hull if body.shape == "hull" else body.mesh
    placed = PlacedPoints(solid.vertices * body.size, body.position, body.quaternion)
    return placed, (np.arange(len(solid.vertices))[None] if body.shape == "hull" else solid.faces)


def judged(case, rng):
    """What `harness.distance` and `harness.touching` say of a case, against its certificate."""
    sizes, positions, q = placed_at(rng, case.gap, case.ratio, case.far)
    a, b = (
        harness.Body(solid(rng, form), position, turn, size, shape=case.shape)
        for form, position, turn, size in zip(case.forms, positions, q, sizes, strict=True)
    )
    truth, found, back = certified(a, b), harness.distance(a, b), harness.distance(b, a)
    band = OF_SIZE * max(sizes) + OF_GAP * truth.gap
    off = max(abs(found.gap - truth.gap), abs(back.gap - truth.gap))
    wrong = []
    if off > band:
        wrong.append(f"gap {found.gap!r}, not {truth.gap!r}")
    # the points are written in the world, where coordinates have so many digits
    digits = 1e-15 * np.abs(positions).max()
    if abs(np.linalg.norm(np.subtract(*found.points)) - found.gap) > band + 4 * digits:
        wrong.append("the nearest points are not as far apart as the gap")
    if harness.touching(a, b) != (found.gap == 0.0):
        wrong.append("touching at a gap, or not touching at none")
    return Judged(max(0.0, off - OF_GAP * truth.gap) / max(sizes), "; ".join(wrong))


def judge_many(count, seed=0):
    """The largest error of a gap, of a size, and what is wrong of which cases."""
    rng, most, wrong = np.random.default_rng(seed), 0.0, []
    for _ in range(count):
        case = random_case(rng)
        result = judged(case, rng)
        most = max(most, result.error)
        if result.wrong:
            wrong.append((case, result.wrong))
    return most, wrong


if __name__ == "__main__":
    most, wrong = judge_many(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(f"{len(wrong)} wrong of {sys.argv[1]}; largest error of a gap {most:.1e} of a size")
    for case, what in wrong[:10]:
        print(f"  {case}: {what}")
