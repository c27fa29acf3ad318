"""Scenes for tests: small, seeded, and made without files."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Generator, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from harness.backends.registry import BackendError
from harness.errors import NotInstalledError
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.hull import convex_hull
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene

# Both workers and hundreds of processes import the same sources, which are compiled once: where the environment says
# that nothing compiled is kept, seconds of each worker and a second of each process go into compiling them again.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# the first call of a kernel compiles it, so a time limit an example would fail at random
settings.register_profile("harness", deadline=None)
settings.register_profile("quick", settings.get_profile("harness"), max_examples=25)
settings.load_profile("harness")

# What collecting makes is all kept: a search for garbage would find nothing, again and again.
gc.disable()

HERE = Path(__file__).parent

# With several workers (`-n 2`) the files that take longest come first, so that no worker is left alone with one: these,
# then those of the rooms below. Right after the longest, whose kernels one worker compiles, come those that fork most:
# a fork costs as much as there is memory, three times as much once a worker has compiled and drawn.
LONGEST_FILES = (
    "runner/test_stability_cases.py",
    "compare/test_comparison.py",
    "compare/test_liars.py",
    "compare/test_reproduction.py",
    "compare/test_query_comparison.py",
    "compare/test_gap_atlas.py",
    "compare/test_document.py",
    "truth/test_truth_ask.py",
    "test_child_process.py",
    "test_docstring_examples.py",
    "browser/test_pages.py",
    "runner/test_odd_environments.py",
    "runner/test_servers.py",
    "runner/test_cluster.py",
    "runner/test_killed_sweep.py",
    "cli/test_trouble.py",
    "runner/test_isolation.py",
    "test_one_new_method.py",
    "pair/test_pair.py",
    "test_readme.py",
    "compare/test_exact_distance.py",
    "experiment/test_any_experiment.py",
    "backends/test_peers.py",
    "test_one_new_file.py",
    "test_docstring_examples.py",
    "runner/test_accuracy.py",
    "runner/test_many_runs.py",
    "runner/test_warm_up.py",
    "narrowphase/test_gap_pairs.py",
    "browser/test_live.py",
)
LONGEST = ("runner", "compare", "narrowphase", "cli", "motion")
# Rooms whose tests share what takes seconds to make, all pages of a report and servers: one worker has them all.
TOGETHER = ("report", "cli")


def pytest_configure(config: pytest.Config) -> None:
    """Try a quarter of the examples where slow tests are left out."""
    if config.option.markexpr == "not slow":
        settings.load_profile("quick")


# of what would go on without it, and find less
needs_pybullet = pytest.mark.skipif(find_spec("pybullet") is None, reason="pip install 'harness[pybullet]'")


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call() -> Generator[None, object, object]:
    """Beyond CPython 3.11 pybullet is an extra: what asks for it or its meshes is passed over where it is not there."""
    try:
        return (yield)
    except (BackendError, ModuleNotFoundError, NotInstalledError) as error:
        if find_spec("pybullet") is None and "pybullet" in str(error):
            pytest.skip(str(error))
        raise


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    def place(item: pytest.Item) -> int:
        file, room = item.path.relative_to(HERE).as_posix(), item.path.parent.name
        if file in LONGEST_FILES:
            return LONGEST_FILES.index(file)
        return len(LONGEST_FILES) + (LONGEST.index(room) if room in LONGEST else len(LONGEST))

    items.sort(key=place)


def pytest_collection_finish() -> None:
    """What is there by now stays: the garbage collector, and those of forked processes, need not look at it again."""
    gc.enable()
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """A file's tests go to one worker, in their order: they share servers, and some look at their own children."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return next((room for room in TOGETHER if file.startswith(f"tests/{room}/")), file)

    config.option.loadscopereorder = False
    return Scheduling(config, log)


def slow_beyond(values: Iterable[Any], count: int = 1) -> list[Any]:
    """Parameters of which the quick tests have the first few only."""
    return [pytest.param(value, marks=() if place < count else pytest.mark.slow) for place, value in enumerate(values)]


def examples(count: int) -> int:
    """How many examples to try where the whole suite tries so many."""
    return max(1, count * settings.default.max_examples // 100)


def make_bodies(positions, velocities=None, *, sizes=None, masses=None, spins=None, quaternions=None) -> Bodies:
    positions = np.array(positions, float).reshape(-1, 3)
    count = len(positions)
    sizes = np.ones(count) if sizes is None else np.array(sizes, float)
    return Bodies(
        positions=positions,
        velocities=np.zeros((count, 3)) if velocities is None else np.array(velocities, float).reshape(-1, 3),
        quaternions=np.tile([1.0, 0, 0, 0], (count, 1)) if quaternions is None else np.array(quaternions, float),
        spins=np.zeros((count, 3)) if spins is None else np.array(spins, float),
        sizes=sizes,
        masses=sizes**3 if masses is None else np.array(masses, float),
    )


def cube_mesh() -> Mesh:
    """A cube of space diagonal 1."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(12)
    hull = convex_hull(corners)
    return Mesh("cube", hull.vertices, hull.faces, hull, "cube", watertight=True, convex=True)


def random_scene(shape: str, count: int, side: float, seed: int = 0) -> Scene:
    """Spinning cubes or spheres, overlapping as chance has it."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(count, 4))
    bodies = make_bodies(
        rng.uniform(-side / 2 + 0.5, side / 2 - 0.5, (count, 3)),
        rng.normal(size=(count, 3)),
        spins=rng.normal(size=(count, 3)),
        quaternions=quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True),
    )
    return Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, side / 2)))


@pytest.fixture
def cube() -> Mesh:
    return cube_mesh()
