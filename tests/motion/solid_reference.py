"""The rules of event-driven solids, as plainly as possible: after each event every pair and wall it concerns is asked.

Contacts are found by tiny steps and bisection on FCL's `collide`, never by a distance; walls by the vertices.
"""

from itertools import combinations
from math import inf

import fcl
import numpy as np
from scipy.spatial.transform import Rotation

from harness.backends.fcl_objects import FclObjects
from harness.motion.predictive.codes import Event

PAIR, WALL = Event.PAIR, Event.WALL


class SolidReference:
    """A handful of hulls or meshes in a box."""

    def __init__(self, scene, response="reflect", restitution=1.0, step=2e-3):
        bodies = scene.bodies
        self.x, self.v = bodies.positions.copy(), bodies.velocities.copy()
        self.turns, self.spins = Rotation.from_quat(np.roll(bodies.quaternions, -1, axis=1)), bodies.spins
        self.sizes, self.masses, self.half = bodies.sizes, bodies.masses, scene.box.half
        self.vertices = scene.mesh.hull.vertices.copy()
        self.objects = FclObjects(scene)
        self.response, self.restitution, self.step = response, restitution, step
        self.time, self.events = 0.0, []
        self.due, self.changed = {}, set(range(len(self.x)))

    def poses(self, k, times):
        turns = Rotation.from_rotvec(np.outer(times, self.spins[k])) * self.turns[k]
        return self.x[k] + np.outer(times - self.time, self.v[k]), turns

    def pair_time(self, i, j):
        """From the meeting of the bounding spheres to the closest approach of the centres."""
        d, w = self.x[j] - self.x[i], self.v[j] - self.v[i]
        b, reach = d @ w, (self.sizes[i] + self.sizes[j]) / 2
        if b >= 0.0:
            return inf
        root = b * b - (w @ w) * (d @ d - reach * reach)
        if root < 0.0:
            return inf
        begin, end = max(0.0, (-b - np.sqrt(root)) / (w @ w)), -b / (w @ w)

        def touch(times):
            (x, turn), (y, other_turn) = self.poses(i, times), self.poses(j, times)
            q, p = np.roll(turn.as_quat(), 1, axis=1), np.roll(other_turn.as_quat(), 1, axis=1)
            for k in range(len(times)):
                self.objects.place_one(i, x[k], q[k])
                self.objects.place_one(j, y[k], p[k])
                yield fcl.collide(self.objects.objects[i], self.objects.objects[j]) > 0

        return self.first(begin, end, touch)

    def wall_time(self, i, face):
        axis, up = divmod(face, 2)
        sign = 2 * up - 1
        if sign * self.v[i, axis] <= 0.0:
            return inf

        def beyond(times):
            x, turn = self.poses(i, times)
            heights = sign * turn.as_matrix()[:, axis] @ self.vertices.T * self.sizes[i]
            yield from sign * x[:, axis] + heights.max(axis=1) >= self.half[axis]

        begin = max(0.0, (sign * self.half[axis] - sign * self.sizes[i] / 2 - self.x[i, axis]) / self.v[i, axis])
        end = max(begin, (sign * self.half[axis] - self.x[i, axis]) / self.v[i, axis])
        return self.first(begin, end, beyond)

    def first(self, begin, end, touching):
        """The first moment of touching, to rounding, unless it is over within a step. Times from now on."""
        times = self.time + np.append(np.arange(begin, end, self.step), end)
        for k, touches in enumerate(touching(times)):
            if touches:
                if k == 0:
                    return times[0]
                low, high = times[k - 1], times[k]
                for _ in range(50):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if next(touching(np.array([middle]))) else (middle, high)
                return high
        return inf

    def happen(self):
        """The next event. False if there is none."""
        for i, j in combinations(range(len(self.x)), 2):
            if not self.changed.isdisjoint((i, j)):
                self.due[PAIR, i, j] = self.pair_time(i, j)
        for i in self.changed:
            for face in range(6):
                self.due[WALL, i, face] = self.wall_time(i, face)
        time, (kind, i, j) = min((time, event) for event, time in self.due.items())
        if time == inf:
            return False
        self.x += self.v * (time - self.time)
        self.time = time
        if kind == WALL:
            self.v[i, j // 2] *= -1.0
        else:
            self.answer(i, j)
        self.changed = {i} if kind == WALL else {i, j}
        self.events.append((time, kind, i, j))
        return True

    def answer(self, i, j):
        n = self.x[j] - self.x[i]
        n /= np.linalg.norm(n)
        if self.response == "reflect":
            for k in (i, j):
                self.v[k] -= 2.0 * (self.v[k] @ n) * n
            return
        total = self.masses[i] + self.masses[j]
        kick = (1.0 + self.restitution) * ((self.v[j] - self.v[i]) @ n) / total
        self.v[i] += kick * self.masses[j] * n
        self.v[j] -= kick * self.masses[i] * n
