"""Threads share out the pairs of a frame, and change nothing but the time."""

import numpy as np
import pytest

from harness.broadphase import uniform_grid
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.errors import InputError
from harness.experiment.load import load_text
from harness.narrowphase import hull_pairs, mesh_pairs
from harness.runner.execute import execute
from harness.runner.point import plan_of
from harness.runner.scene_of_point import build_scene
from harness.scene.box import Box
from harness.scene.scene_files import SceneFiles
from harness.threads import Threads
from tests.conftest import cube_mesh

COUNTERS = (
    "pair_tests",
    "narrow_tests",
    "pair_hits",
    "hull_tests",
    "hull_searches",
    "fcl_tests",
    "contained_pairs",
    "event_digest",
)


def point_of(threads, scene="{shape: sphere, count: 400, box: [9, 9, 9]}"):
    engine = f"{{backend: fcl, algorithm: grid, threads: {threads}}}"
    text = f"title: t\nscene: {scene}\nmotion: {{duration: 0.5, dt: 1/60, response: none}}\nengine: {engine}\n"
    return load_text(text, "threads.yaml").points[0]


@pytest.mark.parametrize("items", [0, 1, 31, 64, 1000])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_parts_cover_all_items_once(items, count):
    parts = Threads(count).parts(items, 10)
    assert [place for begin, end in parts for place in range(begin, end)] == list(range(items))
    assert len(parts) <= 8 * count


def test_what_comes_of_parts_stands_in_their_order():
    threads = Threads(3)
    found = threads.each(lambda begin, end: list(range(begin, end)), threads.parts(500, 10))
    assert [place for part in found for place in part] == list(range(500))


def test_a_grid_that_is_shared_finds_the_same_pairs_in_the_same_order(monkeypatch):
    monkeypatch.setattr(uniform_grid, "FEWEST_SHARED", 8)
    rng = np.random.default_rng(5)
    radii, positions = 10.0 ** rng.uniform(-2.0, -0.3, 3000), rng.uniform(-4.0, 4.0, (3000, 3))
    alone, shared = (HierarchicalGrid(radii, Box(np.full(3, 4.0))) for _ in range(2))
    shared.share_with(Threads(3))
    for _ in range(3):
        expected = alone.close_pairs(positions)
        assert len(expected) > 1000
        np.testing.assert_array_equal(shared.close_pairs(positions), expected)
        assert shared.pair_tests == alone.pair_tests
        positions = positions + 0.01


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("size", ["1", "{uniform: [0.3, 1.0]}"])
def test_counters_and_digests_are_those_of_one_thread(shape, size, monkeypatch):
    for module in (uniform_grid, hull_pairs, mesh_pairs):
        monkeypatch.setattr(module, "FEWEST_SHARED", 8)
    shared, each = [], Threads.each
    monkeypatch.setattr(Threads, "each", lambda self, work, parts: shared.append(len(parts)) or each(self, work, parts))
    scene = f"{{shape: {shape}, mesh: cube.ply, count: 400, box: [9, 9, 9], size: {size}, overlap: allow}}"
    files = SceneFiles.of((cube_mesh(),))
    found = [execute(point_of(threads, scene), files).metrics for threads in (1, 2, 3)]
    told = [{name: metrics[name] for name in COUNTERS if name in metrics} for metrics in found]
    assert told[0]["pair_hits"] > 100
    assert told[0] == told[1] == told[2]
    assert sum(parts > 1 for parts in shared) >= 60  # 30 frames of each


def test_a_plan_says_which_time_tells_what_threads_save():
    point = point_of(2)
    (warning,) = plan_of(point, build_scene(point, SceneFiles())).warnings
    assert warning.startswith("2 THREADS: CPU times are sums over them")
    assert plan_of(point_of(1), build_scene(point, SceneFiles())).warnings == ()


@pytest.mark.parametrize(
    ("engine", "reason"),
    [
        ("algorithm: tree, threads: 2", "algorithm tree runs on one thread; threads 2 can be had with grid"),
        ("algorithm: grid, query: impact, threads: 2", "query impact runs on one thread, not on 2"),
        ("algorithm: grid, threads: 0", "threads"),
    ],
)
def test_what_cannot_be_shared_is_refused(engine, reason):
    scene = "{shape: sphere, count: 4, box: [9, 9, 9]}"
    text = f"title: t\nscene: {scene}\nmotion: {{response: none}}\nengine: {{{engine}}}\n"
    with pytest.raises(InputError) as refused:
        load_text(text, "threads.yaml")
    assert reason in str(refused.value)
    assert "threads.yaml:4:" in str(refused.value)
