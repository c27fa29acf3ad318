"""How the pairs of each family are drawn: where two bodies start, how they fly, and which drafts are kept.

The engine proposes here, and proves nothing: it says when a draft would touch, so that grazing pairs graze and near
misses miss. What is true of a draft is proven elsewhere.

All numbers are rounded to few digits, so that a table of them stays small; a case is what the table says.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from harness.arrays import Flags, Floats
from harness.pair.body import Body
from harness.pair.impact import time_of_impact
from harness.scene.mesh import Mesh
from harness.truth.declaration import FamilySpec
from harness.vocabulary import Shape

# Of the size: the gap down to which the engine proposes.
TOLERANCE = 1e-12
DIGITS = 6  # after the point, of every number of a motion
_HALVINGS = 26


class Drafts(NamedTuple):
    """Pairs that may become cases; arrays as of `Flights`, by side, and windows.

    Attributes
    ----------
    positions, velocities, spins : two (n, 3) float arrays
    quaternions : two (n, 4) float arrays
    windows : (n,) float array, s
    """

    positions: tuple[Floats, Floats]
    quaternions: tuple[Floats, Floats]
    velocities: tuple[Floats, Floats]
    spins: tuple[Floats, Floats]
    windows: Floats


@dataclass(frozen=True)
class Draw:
    """What a family draws from.

    Parameters
    ----------
    rng : numbers
    spec : what the file says of the family
    meshes : of both bodies
    shape : of both
    sizes : of both, m
    count : how many drafts
    """

    rng: np.random.Generator
    spec: FamilySpec
    meshes: tuple[Mesh, Mesh]
    shape: Shape
    sizes: tuple[float, float]
    count: int

    @property
    def reach(self) -> float:
        """m, the distance of the centres at which the spheres around the bodies touch."""
        return (self.sizes[0] + self.sizes[1]) / 2.0

    def uniform(self, low: float, high: float) -> Floats:
        """(n, 1) numbers."""
        return self.rng.uniform(low, high, (self.count, 1))

    def powers(self, low: float, high: float) -> Floats:
        """(n, 1) numbers, uniform in their logarithms."""
        return np.asarray(np.exp(self.uniform(np.log(low), np.log(high))))

    def directions(self, dimensions: int = 3) -> Floats:
        """(n, 3) unit vectors, or unit quaternions."""
        vectors = self.rng.normal(size=(self.count, dimensions))
        return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))

    def spins(self) -> Floats:
        """(n, 3) rad/s."""
        return np.asarray(self.directions() * self.spec.spin.sample(self.rng, self.count)[:, None])

    def speeds(self) -> Floats:
        """(n, 1) m/s."""
        return np.asarray(self.spec.speed.sample(self.rng, self.count)[:, None])

    def drafts(
        self, offset: Floats, relative: Floats, turns: tuple[Floats, Floats], spins: tuple[Floats, Floats]
    ) -> Drafts:
        """Drafts of pairs, flying together anywhere; `offset` (n, 3) m and `relative` (n, 3) m/s of the second."""
        origin, drift = self.rng.uniform(-1.0, 1.0, (2, 1, 3)) * np.ones((self.count, 1))
        return _rounded(
            Drafts(
                (origin, origin + offset),
                turns,
                (drift, drift + relative),
                spins,
                np.full(self.count, self.spec.window),
            )
        )

    def turns(self) -> tuple[Floats, Floats]:
        """Two (n, 4) quaternions."""
        return self.directions(4), self.directions(4)

    def first_touch(self, drafts: Drafts) -> Floats:
        """(n,) s, when the engine says that drafts touch; inf for never."""
        bodies = [
            Body(
                self.meshes[side],
                drafts.positions[side],
                drafts.quaternions[side],
                self.sizes[side],
                drafts.velocities[side],
                drafts.spins[side],
                self.shape,
            )
            for side in (0, 1)
        ]
        times = np.asarray(time_of_impact(bodies[0], bodies[1], float(drafts.windows.max()), TOLERANCE))
        return np.where(times <= drafts.windows, times, np.where(np.isnan(times), times, np.inf))


Family: TypeAlias = Callable[[Draw], tuple[Drafts, Flags]]
"""Drafts, and (n,) which of them are of the family."""


def random(draw: Draw) -> tuple[Drafts, Flags]:
    """One body shot at another, anywhere within the spheres around them."""
    miss = draw.reach * 0.95 * np.sqrt(draw.uniform(0.0, 1.0))
    drafts = _shot(draw, draw.reach * draw.uniform(1.1, 2.5), miss, draw.turns(), (draw.spins(), draw.spins()))
    return drafts, draw.first_touch(drafts) != 0.0


def grazing(draw: Draw) -> tuple[Drafts, Flags]:
    """A shot so far off the centre that it touches only just: 1e-5 to 1e-2 of the reach farther out it would miss."""
    drafts = _beside_the_limit(draw, -draw.powers(1e-5, 1e-2))
    return drafts, np.isfinite(draw.first_touch(drafts))


def near_misses(draw: Draw) -> tuple[Drafts, Flags]:
    """A shot that misses by 1e-5 to 1e-2 of the reach."""
    drafts = _beside_the_limit(draw, draw.powers(1e-5, 1e-2))
    return drafts, np.isinf(draw.first_touch(drafts))


def parting_ribs(draw: Draw) -> tuple[Drafts, Flags]:
    """Bodies whose spheres overlap and whose centres part, until a rib that comes round strikes."""
    way = draw.directions()
    drafts = draw.drafts(
        way * draw.reach * draw.uniform(0.75, 1.0), way * draw.speeds(), draw.turns(), (draw.spins(), draw.spins())
    )
    times = draw.first_touch(drafts)
    return drafts, np.isfinite(times) & (times > 1e-6)


def resting(draw: Draw) -> tuple[Drafts, Flags]:
    """Bodies at rest relative to each other, in turn: at a gap, overlapping, and at a gap with a slow spin."""
    turns, still = draw.turns(), np.zeros((draw.count, 3))
    shot = _shot(
        draw,
        1.5 * draw.reach * np.ones((draw.count, 1)),
        0.3 * draw.reach * draw.uniform(0.0, 1.0),
        turns,
        (still, still),
    )
    times = draw.first_touch(shot)
    relative = shot.velocities[1] - shot.velocities[0]
    way = relative / np.linalg.norm(relative, axis=1, keepdims=True)
    kind = np.arange(draw.count)[:, None] % 3
    back = np.where(kind == 1, -1e-2, draw.powers(1e-5, 1e-1)) * draw.reach
    hits = np.isfinite(times)
    offset = shot.positions[1] - shot.positions[0] + relative * np.where(hits, times, 0.0)[:, None] - way * back
    slow = np.where(kind == 2, 1e-2, 0.0)
    return draw.drafts(offset, still, turns, (slow * draw.spins(), slow * draw.spins())), hits


def flat_contacts(draw: Draw) -> tuple[Drafts, Flags]:
    """Faces that stay parallel, of bodies whose outermost vertices along their own x axes are a face, as a cube's are.

    In turn: face flies on face, turned anyhow; the same, spinning about the normal of the faces; face touches face
    exactly, at the start; face spins above face at a gap; face slides along face at a gap.
    """
    count, kind = draw.count, np.arange(draw.count)[:, None] % 5
    normal = np.array([1.0, 0.0, 0.0]) * np.ones((count, 1))
    turn = np.where(kind == 0, np.round(draw.directions(4), DIGITS), [1.0, 0.0, 0.0, 0.0])
    span = draw.sizes[0] * draw.meshes[0].vertices[:, 0].max() - draw.sizes[1] * draw.meshes[1].vertices[:, 0].min()
    gap = np.where(kind == 2, 0.0, np.where(kind < 2, draw.uniform(0.1, 1.0), draw.powers(1e-5, 1e-1)) * draw.reach)
    aside = draw.rng.uniform(-0.25, 0.25, (count, 3)) * draw.reach * [0.0, 1.0, 1.0]
    sliding = draw.directions() * [0.0, 1.0, 1.0]
    relative = np.where(kind < 2, -normal, np.where(kind == 4, sliding, 0.0)) * draw.speeds()
    spins = [
        np.where((kind == 1) | (kind == 3), normal, 0.0) * draw.spec.spin.sample(draw.rng, count)[:, None] for _ in "ab"
    ]
    drafts = draw.drafts(
        _turned(turn, normal * (span + gap) + aside), _turned(turn, relative), (turn, turn), (spins[0], spins[1])
    )
    # where they touch exactly, no digit may be lost: the first body is at the origin
    exact = (
        np.where(kind == 2, 0.0, drafts.positions[0]),
        np.where(kind == 2, normal * span + np.round(aside, DIGITS), drafts.positions[1]),
    )
    return drafts._replace(positions=exact), np.ones(count, bool)


def fast_spins(draw: Draw) -> tuple[Drafts, Flags]:
    """As random, from nearby."""
    miss = draw.reach * 0.95 * np.sqrt(draw.uniform(0.0, 1.0))
    drafts = _shot(draw, draw.reach * draw.uniform(1.02, 1.2), miss, draw.turns(), (draw.spins(), draw.spins()))
    return drafts, draw.first_touch(drafts) != 0.0


def size_ratio(draw: Draw) -> tuple[Drafts, Flags]:
    """As random; the sizes are the point."""
    return random(draw)


def interlocked(draw: Draw) -> tuple[Drafts, Flags]:
    """Two rings about their z axes, one through the other, until they strike."""
    turn = draw.directions(4)
    radii = np.linalg.norm(draw.meshes[0].vertices[:, :2], axis=1)
    ring = draw.sizes[0] * (radii.min() + radii.max()) / 2.0
    upright = np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0])
    aside = draw.rng.uniform(-0.05, 0.05, (draw.count, 3)) * draw.sizes[0]
    offset = _turned(turn, np.array([ring, 0.0, 0.0]) + aside)
    relative = draw.directions() * draw.speeds()
    drafts = draw.drafts(offset, relative, (turn, _product(turn, upright)), (draw.spins(), draw.spins()))
    return drafts, draw.first_touch(drafts) != 0.0


def never(draw: Draw) -> tuple[Drafts, Flags]:
    """In turn: bodies that part, that pass each other, and whose window ends before they touch."""
    kind = np.arange(draw.count)[:, None] % 3
    start = draw.reach * draw.uniform(1.05, 2.5)
    miss = draw.reach * np.where(kind == 1, draw.uniform(1.02, 2.0), draw.uniform(0.0, 0.5))
    drafts = _shot(draw, np.where(kind == 0, -start, start), miss, draw.turns(), (draw.spins(), draw.spins()))
    times = draw.first_touch(drafts)
    cut = np.where(np.isfinite(times), times * draw.uniform(0.3, 0.99)[:, 0], drafts.windows)
    return drafts._replace(windows=np.asarray(np.round(cut, 3), np.float64)), times > 0.1


FAMILIES: dict[str, Family] = {
    family.__name__: family
    for family in (
        *(random, grazing, near_misses, parting_ribs, resting),
        *(flat_contacts, fast_spins, size_ratio, interlocked, never),
    )
}


def _shot(
    draw: Draw, start: Floats, miss: Floats, turns: tuple[Floats, Floats], spins: tuple[Floats, Floats]
) -> Drafts:
    """The second body, `start` (n, 1) m before the first and `miss` (n, 1) m beside it, flies past it."""
    way = draw.directions()
    side = np.cross(way, draw.directions())
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return draw.drafts(side * miss - way * start, way * draw.speeds(), turns, spins)


def _beside_the_limit(draw: Draw, beyond: Floats) -> Drafts:
    """Shots beside the limit between touching and missing, by parts (n, 1) of the reach."""
    shot = _shot(
        draw,
        1.3 * draw.reach * np.ones((draw.count, 1)),
        draw.reach * np.ones((draw.count, 1)),
        draw.turns(),
        (draw.spins(), draw.spins()),
    )
    relative = shot.velocities[1] - shot.velocities[0]
    offset = shot.positions[1] - shot.positions[0]
    along = (offset * relative).sum(axis=1, keepdims=True) / (relative * relative).sum(axis=1, keepdims=True) * relative
    side = offset - along

    def at(share: Floats) -> Drafts:
        return _rounded(shot._replace(positions=(shot.positions[0], shot.positions[0] + along + share * side)))

    inner, outer = np.zeros((draw.count, 1)), np.ones((draw.count, 1))
    for _ in range(_HALVINGS):
        middle = (inner + outer) / 2.0
        touches = np.isfinite(draw.first_touch(at(middle)))[:, None]
        inner, outer = np.where(touches, middle, inner), np.where(touches, outer, middle)
    return at(np.where(beyond < 0.0, inner, outer) + beyond)


def _rounded(drafts: Drafts) -> Drafts:
    def few(column: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        return np.round(column[0], DIGITS) + 0.0, np.round(column[1], DIGITS) + 0.0

    motions = few(drafts.positions), few(drafts.quaternions), few(drafts.velocities), few(drafts.spins)
    return Drafts(*motions, drafts.windows)


def _turned(quaternions: Floats, vectors: Floats) -> Floats:
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    across = 2.0 * np.cross(axis, vectors) / (quaternions * quaternions).sum(axis=1, keepdims=True)
    return np.asarray(vectors + w * across + np.cross(axis, across))


def _product(p: Floats, q: Floats) -> Floats:
    w, u, v = p[:, :1] * q[0] - (p[:, 1:] @ q[1:])[:, None], p[:, :1] * q[1:], p[:, 1:] * q[0]
    return np.concatenate([w, u + v + np.cross(p[:, 1:], q[1:])], axis=1)
