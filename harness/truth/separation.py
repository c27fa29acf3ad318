"""Proofs that two bodies in free flight do not touch for some time.

A proof is a tree of cells. A cell is a part of the first body, a part of the second and an interval of time, and is
proven by an axis n along which the parts stay apart throughout. With s the time from the middle of the interval, at
most h, a point at p from the centre of its body, which spins at w, is at

    n.x + s n.v + p.(n + s m) + e,   m = n x w,   |e| <= s^2 / 2 |m| |w x p|

along n, because the second derivative of n.(exp(ws) p) is m.(w x exp(ws) p), and |w x p| does not change. The way
between the parts along n, without e, is a concave function of s; so what is open at s = -h and at s = h by more than
h^2 / 2 times the sum of both |m| |w x p| is open between. A cell that is not proven is cut: in two intervals, or in the
halves of a part. Every pair of triangles at every time is in a cell; the proof holds when all cells are proven.

All of it is done in floats, for many cells of many cases at once, and every inequality is asked to hold by more than
`_margin`, a bound on all the roundings before it. The axes are guesses, and any number in an axis does: a bad guess
proves nothing. Of the machine it is assumed that it rounds sums, products, quotients and roots as IEEE 754 says, and
that its sines and cosines err by no more than 4 units in the last place.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from harness.arrays import Flags, Floats, Ints
from harness.truth.clearance import PlacedPart, clearance_of_discs, clearance_of_triangles, placed_corners
from harness.truth.flights import Flights
from harness.truth.parts import Parts
from harness.truth.vectors import cross, dot, norm, normalised, rotations, turned

# Cells looked at together: their arrays stay in the processor's cache.
TOGETHER = 8192
# Cells of a case after which its proof is given up, and s, below which an interval is not cut any more.
MOST_CELLS, SHORTEST = 3_000_000, 1e-13
# Time is cut, not space, where a part moves by more than this share of the size of both in the time of a cell.
_MOVED = 0.25
_ROUNDING = 2.0**-53


class Cells(NamedTuple):
    """Parts of both bodies in intervals of time.

    Attributes
    ----------
    cases : (k,) int array
    first, second : (k,) int arrays, nodes
    begin, end : (k,) float arrays, s
    """

    cases: Ints
    first: Ints
    second: Ints
    begin: Floats
    end: Floats

    def some(self, chosen: Flags | Ints | slice) -> Cells:
        """Those of the cells."""
        columns: list[Any] = [column[chosen] for column in self]
        return Cells(*columns)


class Separations(NamedTuple):
    """What became of the proofs.

    Attributes
    ----------
    proven : (n,) bool array, whether the bodies of a case stay apart all the time
    unproven : (n,) float array, s, the beginning of a cell that could not be proven; inf of those that are proven
    cells : (n,) int array, looked at
    """

    proven: Flags
    unproven: Floats
    cells: Ints


def prove_apart(parts: Parts, first: Flights, second: Flights, begin: Floats, end: Floats) -> Separations:
    """Try to prove of every case that no parts of its bodies touch in an interval.

    Parameters
    ----------
    parts : of all meshes
    first, second : Flights of the n cases
    begin, end : (n,) float arrays, s; both ends are of the interval
    """
    count = len(begin)
    motion = _motion(parts, first, second, end)
    unproven, looked_at = np.full(count, np.inf), np.zeros(count, np.int64)
    cases = np.arange(count)
    waiting = Cells(cases, parts.roots[first.meshes], parts.roots[second.meshes], begin.copy(), end.copy())
    while len(waiting.cases):
        some, waiting = _split_off(waiting)
        looked_at += np.bincount(some.cases, minlength=count)
        left, moved = _unproven(parts, motion, some)
        cut = _cut(parts, left, moved)
        hopeless = cut.stuck | (looked_at[left.cases] > MOST_CELLS)
        if hopeless.any():
            np.minimum.at(unproven, left.cases[hopeless], left.begin[hopeless])
            waiting = waiting.some(np.isinf(unproven[waiting.cases]))
        new = cut.cells.some(np.isinf(unproven[cut.cells.cases]))
        waiting = _both(waiting, new)
    return Separations(np.isinf(unproven), unproven, looked_at)


def parts_that_meet(parts: Parts, first: Flights, second: Flights, times: Floats) -> list[Ints]:
    """Of each case the pairs of triangles, (k, 2), that could not be proven apart at an instant (n,) s."""
    motion = _motion(parts, first, second, times)
    cases = np.arange(len(times))
    waiting = Cells(cases, parts.roots[first.meshes], parts.roots[second.meshes], times, times)
    found = [np.empty((0, 3), np.int64)]
    while len(waiting.cases):
        some, waiting = _split_off(waiting)
        left, moved = _unproven(parts, motion, some)
        cut = _cut(parts, left, moved)
        meeting = left.some(cut.stuck)
        found.append(np.column_stack([meeting.cases, parts.leaves[meeting.first], parts.leaves[meeting.second]]))
        waiting = _both(waiting, cut.cells)
    pairs = np.concatenate(found)
    return [pairs[pairs[:, 0] == case, 1:] for case in cases]


def _split_off(cells: Cells) -> tuple[Cells, Cells]:
    """The last cells, as many as are looked at together, and the others."""
    first = max(0, len(cells.cases) - TOGETHER)
    return cells.some(slice(first, None)), cells.some(slice(first))


def _both(one: Cells, other: Cells) -> Cells:
    return Cells(*(np.concatenate(both) for both in zip(one, other, strict=True)))


class _Motion(NamedTuple):
    """Both bodies of each case, coordinates in rows; the second as seen from the first, which does not fly.

    Attributes
    ----------
    offset, drift : (3, n), m and m/s, of the second centre from the first
    quaternions : two (4, n), unit up to rounding
    spins : two (3, n), rad/s
    rates : two (n,), rad/s, at least the lengths of the spins
    sizes : two (n,), m
    reaches : two (n,), m, at least as far as any point is from its centre
    extent : (n,), m, by how much both centres fly, and how far out they are, together
    latest : (n,), s, the end of what is asked
    """

    offset: Floats
    drift: Floats
    quaternions: tuple[Floats, Floats]
    spins: tuple[Floats, Floats]
    rates: tuple[Floats, Floats]
    sizes: tuple[Floats, Floats]
    reaches: tuple[Floats, Floats]
    extent: Floats
    latest: Floats


class _Cut(NamedTuple):
    """What becomes of cells that are not proven: smaller cells, or (k,) `stuck` where there are none."""

    cells: Cells
    stuck: Flags


def _motion(parts: Parts, first: Flights, second: Flights, end: Floats) -> _Motion:
    both = (first, second)
    one, other = (np.ascontiguousarray(body.spins.T) for body in both)
    far, other_far = (
        parts.radii[root] + norm(parts.centres[:, root]) for root in (parts.roots[b.meshes] for b in both)
    )
    positions = np.abs(first.positions) + np.abs(second.positions)
    velocities = np.abs(first.velocities) + np.abs(second.velocities)
    return _Motion(
        np.ascontiguousarray((second.positions - first.positions).T),
        np.ascontiguousarray((second.velocities - first.velocities).T),
        (normalised(first.quaternions.T), normalised(second.quaternions.T)),
        (one, other),
        (norm(one) * (1.0 + 1e-14), norm(other) * (1.0 + 1e-14)),
        (first.sizes, second.sizes),
        (first.sizes * far * (1.0 + 1e-14), second.sizes * other_far * (1.0 + 1e-14)),
        positions.sum(axis=1) + velocities.sum(axis=1) * end,
        end,
    )


def _margin(motion: _Motion, cases: Ints, half: Floats) -> Floats:
    """What the roundings of a way between two parts along an axis can amount to, m.

    In units of 2^-53: the offset and its sum with the flight, 10 of the extent. The angle of a spin 4 of itself and
    its sine and cosine 8, the quaternion 16 more and normalised 5, a matrix 4 times that and 20: of a point 16 times
    the angle and 240 of its distance from the centre, with the products that follow; and of its motion as many again,
    times the angle of the cell.
    """
    total = 32.0 * motion.extent[cases]
    for side in (0, 1):
        rate = motion.rates[side][cases]
        turning = 500.0 + 32.0 * rate * motion.latest[cases]
        total += motion.reaches[side][cases] * turning * (1.0 + half * rate)
    return np.asarray(_ROUNDING * total)


def _part(parts: Parts, motion: _Motion, side: int, cases: Ints, nodes: Ints, middle: Floats) -> PlacedPart:
    size, spin = motion.sizes[side][cases], motion.spins[side][:, cases]
    turn = rotations(motion.quaternions[side][:, cases], spin, middle)
    return PlacedPart(
        turn,
        spin,
        motion.rates[side][cases],
        size,
        size * turned(turn, parts.centres[:, nodes]),
        size * parts.radii[nodes],
        turned(turn, parts.normals[:, nodes]),
        size * parts.halves[nodes],
    )


def _some(part: PlacedPart, chosen: Ints) -> PlacedPart:
    return PlacedPart(*(column[..., chosen] for column in part))


def _unproven(parts: Parts, motion: _Motion, cells: Cells) -> tuple[Cells, Flags]:
    """The cells that are not proven, and of which of them time should be cut."""
    middle = 0.5 * (cells.begin + cells.end)
    half = 0.5 * (cells.end - cells.begin) * (1.0 + 1e-14) + 1e-15 * cells.end
    one = _part(parts, motion, 0, cells.cases, cells.first, middle)
    other = _part(parts, motion, 1, cells.cases, cells.second, middle)
    drift = motion.drift[:, cells.cases]
    offset = motion.offset[:, cells.cases] + drift * middle
    margin = _margin(motion, cells.cases, half)
    open_ = np.zeros(len(middle), np.bool_)
    between = offset + other.centre - one.centre
    for guess in range(3):
        left = np.flatnonzero(~open_)
        if not len(left):
            break
        a, b, way = _some(one, left), _some(other, left), between[:, left]
        if guess == 0:
            axis = normalised(way)
        else:
            axis = (a if guess == 1 else b).normal
            axis = np.where(dot(axis, way) < 0.0, -axis, axis)
        clearance = clearance_of_discs(a, b, axis, way, drift[:, left], half[left])
        open_[left] = clearance > margin[left]
    left = np.flatnonzero(~open_)
    triangles, others = parts.leaves[cells.first[left]], parts.leaves[cells.second[left]]
    tried = np.flatnonzero((triangles >= 0) & (others >= 0))
    if len(tried):
        which = left[tried]
        a, b = _some(one, which), _some(other, which)
        clearance = clearance_of_triangles(
            placed_corners(parts, a, triangles[tried]),
            placed_corners(parts, b, others[tried]),
            (a, b),
            (a.size * parts.around[triangles[tried]], b.size * parts.around[others[tried]]),
            (offset[:, which], drift[:, which]),
            half[which],
        )
        open_[which] = clearance > margin[which]
        left = np.flatnonzero(~open_)
    fastest = norm(drift[:, left])
    for part in (one, other):
        fastest += norm(cross(part.spin[:, left], part.centre[:, left])) + part.rate[left] * part.radius[left]
    moved = half[left] * fastest > _MOVED * (one.radius[left] + other.radius[left])
    return cells.some(left), moved


def _cut(parts: Parts, cells: Cells, moved: Flags) -> _Cut:
    """Smaller cells in place of those not proven: of half the time where the parts moved far in it, else of space."""
    whole = (parts.leaves[cells.first] >= 0) & (parts.leaves[cells.second] >= 0)
    in_time = moved | whole
    middle = 0.5 * (cells.begin + cells.end)
    inside = (middle > cells.begin) & (middle < cells.end) & (cells.end - cells.begin > SHORTEST)
    stuck = in_time & ~inside & whole
    in_time &= inside
    early, late = cells.some(in_time), cells.some(in_time)
    early, late = early._replace(end=middle[in_time]), late._replace(begin=middle[in_time])
    rest = cells.some(~in_time & ~stuck)
    of_first = parts.leaves[rest.second] >= 0
    # where both can be halved, the larger; sizes of the bodies do not matter much for that
    of_first |= (parts.leaves[rest.first] < 0) & (parts.radii[rest.first] >= parts.radii[rest.second])
    one, other = rest.some(of_first), rest.some(~of_first)
    pieces = [
        early,
        late,
        one._replace(first=parts.left[one.first]),
        one._replace(first=parts.right[one.first]),
        other._replace(second=parts.left[other.second]),
        other._replace(second=parts.right[other.second]),
    ]
    return _Cut(Cells(*(np.concatenate(column) for column in zip(*pieces, strict=True))), stuck)
