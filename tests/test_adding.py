"""To add something is to write one file: each kind is written into a copy of the package, and used by the commands."""

import json
import os
import shutil
import sqlite3
import subprocess
import sys
import textwrap
from contextlib import closing
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "harness"

pytestmark = pytest.mark.slow


class Copy:
    """A copy of the package, into which files are written, and whose commands are run."""

    def __init__(self, folder):
        self.folder = folder
        shutil.copytree(PACKAGE, folder / "harness", ignore=shutil.ignore_patterns("__pycache__"))

    def write(self, path, text):
        (self.folder / path).write_text(textwrap.dedent(text))

    def add_line(self, path, after, line):
        """A line of a file behind the one that begins so."""
        file = self.folder / path
        lines = file.read_text().splitlines(keepends=True)
        place = next(place for place, text in enumerate(lines) if text.startswith(after))
        file.write_text("".join([*lines[: place + 1], f"{line}\n", *lines[place + 1 :]]))

    def run(self, *arguments):
        environment = os.environ | {"PYTHONPATH": str(self.folder)}
        done = subprocess.run(
            [sys.executable, "-m", "harness", *map(str, arguments)],
            cwd=self.folder, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    def runs(self, database="results/results.db"):
        return json.loads(self.run("export", "--db", database, "--format", "json"))["runs"]


@pytest.fixture
def copy(tmp_path):
    return Copy(tmp_path)


EXPERIMENT = """
    title: Spheres
    scene: {shape: sphere, count: 20, box: [4, 4, 4], size: {uniform: [0.2, 1.0]}}
    motion: {duration: 0.5}
    measure: {repeats: 1}
    engine: {backend: BACKEND, algorithm: ALGORITHM}
"""


def experiment(backend, algorithm):
    return EXPERIMENT.replace("BACKEND", backend).replace("ALGORITHM", algorithm)


def test_a_backend_is_one_file_and_its_version_is_kept_with_the_sweep(copy):
    copy.write(
        "harness/backends/distances.py",
        """
        import numpy as np

        class Distances:
            name = "distances"
            shapes = ("sphere",)

            def tolerance(self, shape):
                return 1e-12

            def load(self, scene):
                self.radii = scene.bodies.radii

            def pairs(self, positions, quaternions):
                i, j = np.triu_indices(len(positions), 1)
                near = np.linalg.norm(positions[i] - positions[j], axis=1) <= self.radii[i] + self.radii[j]
                return np.column_stack([i[near], j[near]])

        BACKEND = Distances
        PACKAGE = "hypothesis"  # stands for the package of a library
        """,
    )
    copy.write("mine.yaml", experiment("distances", "native"))
    copy.write("theirs.yaml", experiment("fcl", "brute-force"))
    copy.run("sweep", "mine.yaml", "theirs.yaml")
    mine, theirs = copy.runs()
    assert mine["metrics"]["event_digest"] == theirs["metrics"]["event_digest"]
    listed = {row["name"]: row for row in json.loads(copy.run("list", "--json"))["backends"]}
    assert listed["distances"]["shapes"] == ["sphere"]
    with closing(sqlite3.connect(copy.folder / "results/results.db")) as database:
        ((packages,),) = database.execute("select packages from sweep")
    assert "hypothesis" in json.loads(packages)


def test_a_broad_phase_is_one_file_and_its_word(copy):
    copy.write(
        "harness/broadphase/slices.py",
        '''
        """Slices along x: bodies are sorted, and those whose intervals overlap are tested."""

        import numpy as np

        from harness.broadphase.scheme import Scheme

        class Slices:
            def __init__(self, radii):
                self.radii, self.pair_tests = np.asarray(radii), 0

            def close_pairs(self, positions):
                order = np.argsort(positions[:, 0] - self.radii)
                found = []
                for place, i in enumerate(order):
                    for j in order[place + 1:]:
                        if positions[j, 0] - self.radii[j] > positions[i, 0] + self.radii[i]:
                            break
                        self.pair_tests += 1
                        if np.sqrt(((positions[i] - positions[j]) ** 2).sum()) <= self.radii[i] + self.radii[j]:
                            found.append(sorted((i, j)))
                return np.array(sorted(found), np.int64).reshape(-1, 2)

        SCHEME = Scheme("slices along x", lambda radii, box, size_classes: Slices(radii))
        ''',
    )
    copy.add_line(
        "harness/vocabulary.py", "ALGORITHMS: dict", '    "slices": AlgorithmWord("pairs from slices along x"),'
    )
    copy.write("mine.yaml", experiment("fcl", "slices"))
    copy.write("theirs.yaml", experiment("fcl", "brute-force"))
    copy.run("sweep", "mine.yaml", "theirs.yaml")
    mine, theirs = copy.runs()
    assert mine["metrics"]["event_digest"] == theirs["metrics"]["event_digest"]
    assert mine["metrics"]["pair_tests"] < theirs["metrics"]["pair_tests"]
    stages = json.loads(copy.run("plan", "mine.yaml", "--json"))["runs"][0]["stages"]
    assert "slices along x" in next(stage["why"] for stage in stages if stage["name"] == "sphere_cull")
