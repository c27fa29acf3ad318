"""An experiment, a mesh, a mesh format, a backend, a broad phase and a method are one new file each, and a new word."""

import json
import sqlite3
from contextlib import closing

import pytest

from tests.program_copy import PACKAGE, ProgramCopy

pytestmark = pytest.mark.slow

EXPERIMENT = """
title: Spheres
scene: {shape: sphere, count: 12, box: [3, 3, 3], size: {uniform: [0.2, 1.0]}, mesh: MESH}
motion: {duration: 0.3, dt: 1/20}
measure: {repeats: 1}
engine: {backend: BACKEND, algorithm: ALGORITHM}
"""


@pytest.fixture
def program(tmp_path):
    return with_every_pair(ProgramCopy(tmp_path, compiled=False))


@pytest.fixture
def compiled_program(tmp_path):
    return with_every_pair(ProgramCopy(tmp_path))


def with_every_pair(made):
    made.add("every-pair.yaml", experiment("fcl", "brute-force"))
    made.touched.clear()
    return made


def experiment(backend, algorithm, mesh="null"):
    return EXPERIMENT.replace("BACKEND", backend).replace("ALGORITHM", algorithm).replace("MESH", mesh)


def same_hits(program, name):
    """The run of an experiment, which must have answered the hits of every pair put to FCL."""
    runs = program.sweep(f"{name}.yaml", "every-pair.yaml")
    digests = {run["metrics"]["event_digest"] for run in runs.values()}
    assert len(digests) == 1
    assert runs[name]["metrics"]["events"] > 0
    return runs[name]


def test_an_experiment_is_one_file(program):
    program.run("new", "mine")
    assert "mine" in program.run("list")


def test_a_mesh_is_one_file_beside_the_experiment(program):
    corners = ["0.5 0 0", "-0.5 0.5 0", "-0.5 -0.5 0", "0 0 0.5"]
    faces = ["3 0 1 2", "3 0 3 1", "3 1 3 2", "3 2 3 0"]
    program.add("mine.off", "\n".join(["OFF", "4 4 6", *corners, *faces]) + "\n")
    program.add("tetrahedra.yaml", experiment("fcl", "brute-force", "mine.off"))
    assert same_hits(program, "tetrahedra")["parameters"]["faces"] == 4


def test_a_mesh_format_is_one_file_and_its_word(program):
    program.add(
        "harness/scene/formats/tri.py",
        """
        import numpy as np

        from harness.errors import InputError
        from harness.scene.polygon_mesh import of_triangles

        BEGINS = rb"triangles:"

        def read(content):
            if not content.startswith(b"triangles:"):
                raise InputError("it does not begin with triangles:")
            corners = np.array(content[10:].split(), float).reshape(-1, 3)
            return of_triangles(corners, np.arange(len(corners)).reshape(-1, 3))
        """,
    )
    program.add_mesh_format("tri", "corners of triangles")
    assert program.touched == ["harness/scene/formats/tri.py", "harness/vocabulary.py"]
    corners = "0.5 0 0  -0.5 0.5 0  -0.5 -0.5 0   0.5 0 0  0 0 0.5  -0.5 0.5 0"
    program.add("two.tri", f"triangles: {corners}")
    assert '"faces": 2' in program.run("mesh", "inspect", "two.tri", "--json")
    assert "  .tri  corners of triangles" in program.run("mesh", "--help")
    program.add("two.off", "triangles: 0 0 0")
    assert "two.off: this is a file of another format: name it .tri" in program.refused("mesh", "inspect", "two.off")
    program.add("mine.yaml", experiment("fcl", "brute-force", "tow.tri"))
    assert 'did you mean "two.tri"?' in program.refused("validate", "mine.yaml")


def test_a_backend_is_one_file_and_the_version_of_its_package_is_kept(program):
    program.add(
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
    assert program.touched == ["harness/backends/distances.py"]
    program.add("mine.yaml", experiment("distances", "native"))
    same_hits(program, "mine")
    listed = {row["name"]: row for row in json.loads(program.run("list", "--json"))["backends"]}
    assert listed["distances"]["shapes"] == ["sphere"]
    with closing(sqlite3.connect(program.folder / "results.db")) as database:
        ((packages,),) = database.execute("select packages from sweep")
    assert "hypothesis" in json.loads(packages)
    program.add("hulls.yaml", experiment("distances", "native", "cube.off").replace("sphere", "hull"))
    assert "hulls.yaml:3:16: backend distances has no shape hull, only sphere" in program.refused("plan", "hulls.yaml")


def test_a_broad_phase_is_one_file_and_its_word(compiled_program):
    program = compiled_program
    program.add(
        "harness/broadphase/slices.py",
        """
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
        """,
    )
    program.add_algorithm("slices", "pairs from slices along x")
    assert program.touched == ["harness/broadphase/slices.py", "harness/vocabulary.py"]
    program.add("mine.yaml", experiment("fcl", "slices"))
    assert same_hits(program, "mine")["metrics"]["pair_tests"] < 6 * 66
    stages = json.loads(program.run("plan", "mine.yaml", "--json"))["runs"][0]["stages"]
    assert "slices along x" in next(stage["why"] for stage in stages if stage["name"] == "sphere_cull")


def test_a_method_of_another_kind_is_one_file_and_its_word(compiled_program):
    program = compiled_program
    program.add(
        "harness/methods/both.py",
        """
        from harness.methods.culled import Culled

        class Checked:
            \"\"\"Two detectors, the second of which must find what the first does.\"\"\"

            def __init__(self, first, second):
                self.first, self.second = first, second
                self.counters = first.counters

            def pairs(self, positions, quaternions):
                found = self.first.pairs(positions, quaternions)
                assert found.tolist() == self.second.pairs(positions, quaternions).tolist()
                return found

        class Both(Culled):
            @property
            def scheme(self):
                from harness.broadphase.scheme import scheme_of
                return scheme_of("grid")

            def detector(self, scene, plan):
                return Checked(super().detector(scene, plan), super().detector(scene, plan))

        METHOD = Both
        """,
    )
    program.add_algorithm("both", "the grid, asked twice")
    assert program.touched == ["harness/methods/both.py", "harness/vocabulary.py"]
    program.add("mine.yaml", experiment("fcl", "both"))
    same_hits(program, "mine")


def test_sweep_and_prune_is_such_a_file():
    assert "SCHEME" in (PACKAGE / "broadphase/sap.py").read_text()
    named = [file.name for file in PACKAGE.rglob("*.py") if '"sap"' in file.read_text()]
    assert named == ["vocabulary.py"]
