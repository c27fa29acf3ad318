"""The rules of the event-driven motion, as plainly as possible: every pair and wall is asked again after each event.

The numbers may be floats or Decimals.
"""

from __future__ import annotations

from math import inf, sqrt

from harness.motion.predictive.codes import Event

PAIR, WALL = Event.PAIR, Event.WALL


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def time_to_touch(gap, velocity, reach, root=sqrt):
    approach = dot(gap, velocity)
    if approach >= 0 or approach * approach * 10**31 <= 2 * dot(gap, gap) * dot(velocity, velocity):
        return inf
    distance = dot(gap, gap) - reach * reach
    if distance <= 0:
        return 0
    miss = cross(gap, velocity)
    discriminant = dot(velocity, velocity) * reach * reach - dot(miss, miss)
    if discriminant < 0:
        return inf
    return distance / (root(discriminant) - approach)


class Reference:
    """A few spheres in a box."""

    def __init__(self, positions, velocities, radii, masses, half_box, response="reflect", restitution=1, root=sqrt):
        self.x = [list(p) for p in positions]
        self.v = [list(v) for v in velocities]
        self.r, self.m, self.half = list(radii), list(masses), list(half_box)
        self.response, self.restitution, self.root = response, restitution, root
        self.time = 0
        self.touching = {(i, j) for i, j in self.pairs() if self.gap(i, j) * 10**15 <= max(self.half)}
        self.events = []

    def pairs(self):
        return [(i, j) for i in range(len(self.x)) for j in range(i + 1, len(self.x))]

    def gap(self, i, j):
        d = minus(self.x[j], self.x[i])
        return self.root(dot(d, d)) - self.r[i] - self.r[j]

    def due(self, event):
        """Seconds to an event (kind, i, j or face)."""
        kind, i, j = event
        if kind == WALL:
            axis, up = divmod(j, 2)
            v = self.v[i][axis]
            if v == 0 or (v > 0) != bool(up):
                return inf
            plane = self.half[axis] - self.r[i]
            return max(((plane if up else -plane) - self.x[i][axis]) / v, 0)
        if self.response == "none" and (i, j) in self.touching:
            return inf
        return time_to_touch(minus(self.x[j], self.x[i]), minus(self.v[j], self.v[i]), self.r[i] + self.r[j], self.root)

    def candidates(self):
        return [(PAIR, i, j) for i, j in self.pairs()] + [
            (WALL, i, face) for i in range(len(self.x)) for face in range(6)
        ]

    def step(self):
        """The next event happens. False if there is none."""
        wait, event = min(((self.due(event), event) for event in self.candidates()), default=(inf, None))
        if wait == inf:
            return False
        before = [[list(row) for row in self.x], self.time]
        self.time += wait
        for x, v in zip(self.x, self.v, strict=True):
            for axis in range(3):
                x[axis] += v[axis] * wait
        kind, i, j = event
        if self.response == "none":
            self.separate(before, kind, i, j)
        if kind == WALL:
            self.v[i][j // 2] = -self.v[i][j // 2]
        elif self.response != "none":
            self.answer(i, j)
        self.events.append((self.time, kind, i, j))
        return True

    def separate(self, before, kind, i, j):
        """Pairs that have parted may touch again."""
        for a, b in list(self.touching):
            d, w = minus(self.x[b], self.x[a]), minus(self.v[b], self.v[a])
            if self.gap(a, b) > 0 and dot(d, w) > 0:
                self.touching.discard((a, b))
        if kind == PAIR:
            self.touching.add((i, j))

    def answer(self, i, j):
        d = minus(self.x[j], self.x[i])
        square = dot(d, d)
        if self.response == "reflect":
            for k in (i, j):
                kick = 2 * dot(self.v[k], d) / square
                self.v[k] = [v - kick * c for v, c in zip(self.v[k], d, strict=True)]
            return
        kick = (1 + self.restitution) * dot(d, minus(self.v[j], self.v[i])) / square / (self.m[i] + self.m[j])
        self.v[i] = [v + kick * self.m[j] * c for v, c in zip(self.v[i], d, strict=True)]
        self.v[j] = [v - kick * self.m[i] * c for v, c in zip(self.v[j], d, strict=True)]
