"""Backends that lie, each in one way: what a judge must see through. Each is FCL, but for what stands here."""

from __future__ import annotations

import textwrap

LIARS = {
    # drops one hit of seven at random, of the operating system's own randomness
    "drops-at-random": """
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            return found[[os.urandom(1)[0] >= 37 for _ in range(len(found))]]
    """,
    "random-verdicts": """
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            return found if os.urandom(1)[0] >= 128 else found[:0]
    """,
    "drops-neighbours": """
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            return found[found[:, 1] != found[:, 0] + 1]
    """,
    "last-frame": """
        last = np.empty((0, 2), np.int64)
        def pairs(self, positions, quaternions):
            last, self.last = self.last, super().pairs(positions, quaternions)
            return last
    """,
    # a cache that takes poses for the same that are nearer together than 1e-6
    "caches": """
        asked, said = None, None
        def pairs(self, positions, quaternions):
            if self.asked is None or np.abs(self.asked - positions).max() > 1e-6:
                self.asked, self.said = positions.copy(), super().pairs(positions, quaternions)
            return self.said
    """,
    "learns": """
        calls = 0
        def pairs(self, positions, quaternions):
            self.calls += 1
            found = super().pairs(positions, quaternions)
            return found if self.calls <= 40 else found[:-1]
    """,
    "writes-poses": """
        def pairs(self, positions, quaternions):
            found = super().pairs(positions, quaternions)
            positions[:] += 1.0
            return found
    """,
    "doubles": """
        def pairs(self, positions, quaternions):
            return np.repeat(super().pairs(positions, quaternions), 2, axis=0)
    """,
    "unsorted": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions)[::-1]
    """,
    "turned-round": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions)[:, ::-1]
    """,
    "out-of-range": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions) + 1000
    """,
    "floats": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions).astype(float)
    """,
    "halves-hulls": """
        own_hulls_tolerance = 1e-9
        def load(self, scene):
            sizes = dict.fromkeys(scene.bodies.sizes.tolist())
            if scene.shape == "hull":
                halves = {size: scene.solid_of(size) for size in sizes}
                self.own_hulls = {size: hull_of(one.vertices / 2, one.faces) for size, one in halves.items()}
                scene = dataclasses.replace(scene, hulls=self.own_hulls)
            super().load(scene)
    """,
    # the same, with faces that look as if nothing were outside of them
    "halves-without-faces": """
        own_hulls_tolerance = 1e-9
        def load(self, scene):
            if scene.shape == "hull":
                solids = {solid: scene.solid_of(solid[1], solid[0]) for solid in scene.solids}
                halves = {solid: hull_of(one.vertices / 2, one.faces) for solid, one in solids.items()}
                self.own_hulls = {solid: hull_of(one.vertices, [[0, 0, 0]]) for solid, one in halves.items()}
                scene = dataclasses.replace(scene, hulls=halves)
            super().load(scene)
    """,
    "hulls-inside-out": """
        own_hulls_tolerance = 1e-9
        def load(self, scene):
            super().load(scene)
            if scene.shape == "hull":
                solids = {solid: scene.solid_of(solid[1], solid[0]) for solid in scene.solids}
                self.own_hulls = {one: hull_of(of.vertices / 2, of.faces[:, ::-1]) for one, of in solids.items()}
    """,
    "hulls-of-nobody": """
        own_hulls_tolerance = 1e-9
        def load(self, scene):
            super().load(scene)
            if scene.shape == "hull":
                one = scene.solid_of(float(scene.bodies.sizes[0]))
                self.own_hulls = {123.5: hull_of(one.vertices, one.faces)}
    """,
    "tolerates-by-lot": """
        asked = 0
        def tolerance(self, shape):
            self.asked += 1
            return 1e-3 if self.asked % 3 else 1e-15
    """,
    "inflates-by-1e-3": """
        def load(self, scene):
            bodies = scene.bodies.copy()
            bodies.sizes *= 1.001
            super().load(dataclasses.replace(scene, bodies=bodies))
    """,
    "tolerates-all": """
        def tolerance(self, shape):
            return 0.1
        def pairs(self, positions, quaternions):
            return super().pairs(positions * 1.05, quaternions)
    """,
    "tolerates-nan": """
        def tolerance(self, shape):
            return float("nan")
    """,
    "spheres-for-all": """
        def load(self, scene):
            super().load(dataclasses.replace(scene, shape="sphere"))
    """,
    "blind": """
        def pairs(self, positions, quaternions):
            return super().pairs(positions, quaternions)[:0]
    """,
    "sees-all": """
        def pairs(self, positions, quaternions):
            i, j = np.triu_indices(len(positions), 1)
            return np.column_stack([i, j])
    """,
    "sleeps": """
        def pairs(self, positions, quaternions):
            time.sleep(60)
    """,
    "raises": """
        def pairs(self, positions, quaternions):
            raise RuntimeError("no")
    """,
}

# The kinds of finding by which a liar may be named.
BY_CONTRACT = ("writes-poses", "doubles", "unsorted", "turned-round", "out-of-range", "floats")
BY_CLAIM = (
    "halves-hulls", "halves-without-faces", "hulls-inside-out", "hulls-of-nobody", "tolerates-all", "tolerates-nan",
)  # fmt: skip
BY_CHANGE = {"drops-at-random": "random", "random-verdicts": "random", "learns": "depends on order"}

HEAD = """
import dataclasses, os, time
import numpy as np
from harness.backends.fcl import Fcl
from harness.scene.hull import hull_of

class Plugin(Fcl):
    name = {name!r}
"""


# Of other queries. Each is FCL with the answers of this program's kernels, but for what stands here.
QUERY_LIARS = {
    "gaps-too-wide": """
        def distances(self, positions, quaternions, within):
            pairs, gaps, points = super().distances(positions, quaternions, within)
            near = gaps * 1.01 <= within
            return NearPairs(pairs[near], 1.01 * gaps[near], points[near])
    """,
    "loses-near-pairs": """
        def distances(self, positions, quaternions, within):
            return NearPairs(*(part[1:] for part in super().distances(positions, quaternions, within)))
    """,
    "late": """
        def impacts(self, *asked):
            pairs, times = super().impacts(*asked)
            late = times + 0.01 <= asked[-1]
            return ImpactTimes(pairs[late], times[late] + 0.01)
    """,
    "early": """
        def impacts(self, *asked):
            pairs, times = super().impacts(*asked)
            return ImpactTimes(pairs, np.maximum(times - 0.005, 0.0))
    """,
    "misses-hits": """
        def impacts(self, *asked):
            return ImpactTimes(*(part[:0] for part in super().impacts(*asked)))
    """,
}

# Right gaps, and points that are none.
POINT_LIARS = {
    "points-elsewhere": """
        def distances(self, positions, quaternions, within):
            found = super().distances(positions, quaternions, within)
            return found._replace(points=found.points + 0.1)
    """,
    "points-of-each-other": """
        def distances(self, positions, quaternions, within):
            found = super().distances(positions, quaternions, within)
            return found._replace(points=found.points[:, ::-1])
    """,
    "centres-for-points": """
        def distances(self, positions, quaternions, within):
            found = super().distances(positions, quaternions, within)
            return found._replace(points=positions[found.pairs])
    """,
}

QUERY_HEAD = """
import numpy as np
from harness.backends.fcl import Fcl
from harness.backends.protocol import ImpactTimes, NearPairs
from harness.methods.at_poses import QueryAtPoses
from harness.methods.impact_times import FrameMotion
from harness.vocabulary import MethodName

class Right(Fcl):
    def load(self, scene):
        super().load(scene)
        self.scene = scene
    def asked(self, query, within):
        found = QueryAtPoses(MethodName("fcl", "brute-force", self.scene.shape, query), 1e-9, within)
        found.load(self.scene)
        return found
    def distances(self, positions, quaternions, within):
        return self.asked("distance", within).near(positions.copy(), quaternions.copy())
    def impacts(self, positions, quaternions, velocities, spins, duration):
        middle = positions + 0.5 * duration * velocities
        arrays = [part.copy() for part in (positions, quaternions, middle, velocities, spins)]
        return self.asked("impact", 0.0).impacts(FrameMotion(*arrays, True, duration), duration)

class Plugin(Right):
    name = {name!r}
    queries = ("distance", "impact")
"""


def install(name: str, folder, monkeypatch) -> str:
    """Install one of them as a package of its own would be; its name."""
    metadata = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    module = f"{name.replace('-', '_')}_liar"
    (metadata / "entry_points.txt").write_text(f"[harness.backends]\n{name} = {module}:Plugin\n")
    head, lies = (HEAD, LIARS[name]) if name in LIARS else (QUERY_HEAD, (QUERY_LIARS | POINT_LIARS)[name])
    body = textwrap.indent(textwrap.dedent(lies), 4 * " ")
    (folder / f"{module}.py").write_text(head.format(name=name) + body)
    monkeypatch.syspath_prepend(str(folder))
    return name
