"""A pumpkin: ten ribs, a dimple below and above, a short bent stem. Concave, and yet nearly a sphere.

The surface is a pile of rings of vertices from the bottom to the tip of the stem. Two neighbouring rings of m and n
vertices are joined by m + n triangles, so a pile has twice as many faces as vertices in its rings: any even number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from harness.errors import InputError
from harness.scene.simplify import drop_face, normalised, simplify

RIBS = 10
FINEST = 17002
"""Faces of the pumpkin all smaller ones are simplified from."""
FEWEST = 40
STEM = 0.12  # the last part of the way along the meridian


def pumpkin(faces: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """A pumpkin of exactly so many faces; the same every time.

    Up to 17002 faces it is simplified from the one with 17002, beyond that it is made as it is. A closed surface of
    triangles has an even number of them: an odd number is the next even one with a face left out.

    Parameters
    ----------
    faces : at least 40

    Returns
    -------
    vertices : (v, 3) float array; minimal bounding sphere of diameter 1 about the origin, stem along +z
    faces : (f, 3) int32 array, counter-clockwise seen from outside

    Raises
    ------
    InputError
        If there are too few faces for a pumpkin.
    """
    if faces < FEWEST:
        raise InputError(f"a pumpkin needs at least {FEWEST} faces, not {faces}")
    even = faces + faces % 2
    if even < FINEST:
        return simplify(*_pile(FINEST), faces)
    vertices, triangles = _pile(even)
    if even != faces:
        vertices, triangles = drop_face(vertices, triangles)
    return normalised(vertices), triangles


def _pile(faces: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Vertices and faces of a closed pumpkin with an even number of faces, in no particular unit."""
    places, counts = _rings(faces // 2)
    starts = [1 + sum(counts[:k]) for k in range(len(counts))]
    rings = [_ring(place, count) for place, count in zip(places, counts, strict=True)]
    poles = _poles()
    vertices = np.concatenate([poles[:1], *rings, poles[1:]])
    triangles = [_fan(0, 1, counts[0])[:, ::-1], _fan(len(vertices) - 1, starts[-1], counts[-1])]
    for k in range(len(counts) - 1):
        triangles.append(_band(starts[k], counts[k], starts[k + 1], counts[k + 1]))
    return vertices, np.concatenate(triangles).astype(np.int32)


def _rings(total: int) -> tuple[NDArray[np.float64], list[int]]:
    """Where along the meridian the rings are, and how many vertices each has, together exactly `total`.

    Edges are about equally long, and each rib gets as many vertices as the next: counts are multiples of the ribs. What
    is left over goes to the ring in the dimple below, where there are no ribs.
    """
    fine = np.linspace(0, 1, 4001)
    radius, height = _meridian(fine)
    length = np.concatenate([[0], np.cumsum(np.hypot(np.diff(radius), np.diff(height)))])
    edge = np.sqrt(np.pi * trapezoid(radius, length) / total * 2 / np.sqrt(3))  # of equilateral triangles
    rows = round(length[-1] / (edge * np.sqrt(3 / 4)))
    at = np.interp((np.arange(rows) + 0.5) / rows * length[-1], length, fine)
    around = 2 * np.pi * np.interp(at, fine, radius) / edge / RIBS

    def counts(scale: float) -> NDArray[np.int64]:
        return np.asarray(RIBS * np.maximum(1, np.round(scale * around)), np.int64)

    low, high = 0.1, 10.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if counts(middle).sum() <= total else (low, middle)
    found = counts(low)
    found[1] += total - found.sum()
    return at, found.tolist()


def _meridian(place: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance from the axis and height at places from the bottom (0) to the stem's tip (1), before ribs and bend."""
    body = np.clip(place / (1 - STEM), 0, 1)
    angle = np.pi * (body * 0.965 - 0.5)
    radius = 0.5 * np.cos(angle) ** 0.85
    height = 0.39 * np.sign(angle) * np.abs(np.sin(angle)) ** 0.85
    height += np.where(angle < 0, 0.07, -0.15) * np.exp(-((radius / 0.17) ** 2))
    stem = np.clip((place - 1 + STEM) / STEM, 0, 1)
    side, cap = np.clip(stem / 0.8, 0, 1), np.clip((stem - 0.8) / 0.2, 0, 1)
    radius *= (1 - 0.45 * side + 0.25 * side**4) * (1 - cap)
    height += 0.2 * side + 0.01 * np.sin(np.pi / 2 * cap)
    return radius, height


def _ring(place: float, count: int) -> NDArray[np.float64]:
    """(count, 3) float array: the vertices of the ring at a place along the meridian; the first is in a groove."""
    around = 2 * np.pi * np.arange(count) / count
    radius, height = (float(value[0]) for value in _meridian(np.array([place])))
    groove = 1 - np.abs(np.sin(RIBS / 2 * around)) ** 0.7
    if place <= 1 - STEM:
        depth = 0.15 * (1 - np.exp(-((radius / 0.2) ** 2)))
        scale = 1 - depth * groove
        return np.column_stack([radius * scale * np.cos(around), radius * scale * np.sin(around), height * scale])
    scale = 1 - 0.25 * np.sin(RIBS / 4 * around) ** 2
    _, (foot,) = _meridian(np.array([1 - STEM]))
    rise = height - float(foot)
    bend = 1.5 * rise**2
    return np.column_stack(
        [radius * scale * np.cos(around) + bend, radius * scale * np.sin(around), np.full(count, height)]
    )


def _poles() -> NDArray[np.float64]:
    """(2, 3) float array: the bottom and the tip of the stem."""
    return np.array([_ring(place, 1)[0] for place in (0.0, 1.0)])


def _band(lower: int, few: int, upper: int, many: int) -> NDArray[np.int64]:
    """The triangles between two rings, given the first vertex and the number of each."""
    # Both rings' edges in the order of their middles; each makes a triangle with the corner the other ring is at.
    steps = np.concatenate([(np.arange(few) + 0.5) / few, (np.arange(many) + 0.5) / many])
    ring = np.repeat([0, 1], [few, many])[np.argsort(steps, kind="stable")]
    i, j = np.cumsum(ring == 0) - (ring == 0), np.cumsum(ring == 1) - (ring == 1)
    third = np.where(ring == 0, lower + (i + 1) % few, upper + (j + 1) % many)
    return np.column_stack([lower + i % few, third, upper + j % many])


def _fan(pole: int, first: int, count: int) -> NDArray[np.int64]:
    """The triangles between a pole and a ring around it, counter-clockwise seen from above."""
    ring = np.arange(count)
    return np.column_stack([np.full(count, pole), first + ring, first + (ring + 1) % count])
