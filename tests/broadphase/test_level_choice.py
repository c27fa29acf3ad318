"""Which size classes share a level: it changes what a frame costs, and no pair."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.level_choice import FEWEST_BODIES
from harness.scene.box import Box
from tests.broadphase.every_pair import touching_pairs
from tests.broadphase.test_pair_tests import crowd


def levels_of(grid):
    """The bodies of each level of the last frame that has any, the largest first."""
    levels = grid._cells.levels
    return [int(count) for count in levels["end"] - levels["begin"] if count]


def assert_levels_are_of_their_bodies(grid):
    levels, radii = grid._cells.levels, grid._cells.columns[3]
    assert np.all(levels["cells"] <= levels["budget"])
    for level in levels[levels["end"] > levels["begin"]]:
        of_bodies = radii[level["begin"] : level["end"]]
        assert (level["least"], level["reach"]) == (of_bodies.min(), of_bodies.max())


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["even", "even in the logarithm", "two sizes", "few large"]),
    st.sampled_from([10.0, 100.0, 1e4]),
    st.sampled_from([0.001, 0.05, 0.3, 1.0]),
    st.booleans(),
)
def test_all_pairs_are_found_whichever_classes_share_a_level(seed, sizes, ratio, packing, ties):
    rng = np.random.default_rng(seed)
    count = FEWEST_BODIES + int(rng.integers(0, 100))
    u = rng.uniform(size=count)
    radii = {
        "even": 0.5 / ratio + 0.5 * (1 - 1 / ratio) * u,
        "even in the logarithm": 0.5 * ratio**-u,
        "two sizes": np.where(u < 0.5, 0.5, 0.5 / ratio),
        "few large": np.where(u < 0.02, 0.5, 0.5 / ratio * (1 + u)),
    }[sizes]
    half = (4 / 3 * np.pi * (radii**3).sum() / packing) ** (1 / 3) / 2 * np.array([1.0, rng.uniform(0.2, 1), 2.0])
    grid = HierarchicalGrid(radii, Box(half))
    for spread in (1.0, 0.05, 2.0, 1.0):  # beyond the walls, too, and classes join and part from frame to frame
        positions = rng.uniform(-1, 1, (count, 3)) * half * spread
        if ties:  # on the borders of the cells of the largest, or of cells as fine as the box in 8, and on each other
            step = rng.choice([2 * radii.max(), half.min() / 4])
            some = rng.uniform(size=count) < 0.3
            positions[some] = np.round(positions[some] / step) * step
            positions[: count // 20] = positions[-(count // 20) :]
        assert np.array_equal(grid.close_pairs(positions), touching_pairs(positions, radii))
        assert_levels_are_of_their_bodies(grid)


def test_classes_share_a_level_where_bodies_are_sparse_and_not_where_small_ones_would_crowd_its_cells():
    rng = np.random.default_rng(5)
    radii = 0.5 * 100.0 ** -rng.uniform(0, 1, 4000)
    sparse, dense = (crowd(radii, packing) for packing in (0.001, 0.3))
    grid = HierarchicalGrid(radii, sparse[1])
    grid.close_pairs(sparse[0])
    assert len(levels_of(grid)) == 1
    grid.close_pairs(dense[0])  # the same bodies, closer together
    assert len(levels_of(grid)) > 1
    assert sum(levels_of(grid)) == 4000
    of_two = np.where(np.arange(4000) < 40, 0.5, 0.05)
    positions, box = crowd(of_two, 0.3)
    grid = HierarchicalGrid(of_two, box)
    grid.close_pairs(positions)
    assert levels_of(grid) == [40, 3960]


def test_a_shared_level_saves_tests_of_a_wide_mixture_or_makes_hardly_more():
    rng = np.random.default_rng(6)
    radii = 0.5 * 100.0 ** -rng.uniform(0, 1, 20_000)
    for packing in (0.01, 0.1, 0.3):
        positions, box = crowd(radii, packing)
        grid = HierarchicalGrid(radii, box)
        pairs = grid.close_pairs(positions)
        assert grid.pair_tests < 15 * 20_000
        assert grid.cell_count <= 8 * 20_000 + 8 * len(grid._cells.levels)
        assert len(pairs) > 0


def test_few_bodies_have_a_level_for_each_class():
    rng = np.random.default_rng(7)
    radii = 0.5 * 100.0 ** -rng.uniform(0, 1, FEWEST_BODIES - 1)
    positions, box = crowd(radii, 0.001)
    grid = HierarchicalGrid(radii, box)
    grid.close_pairs(positions)
    assert len(levels_of(grid)) == 5


def test_a_level_that_was_not_shared_keeps_to_its_own_number_of_cells():
    radii = np.where(np.arange(610) < 10, 0.5, 0.02)
    positions, box = crowd(radii, 0.002)  # so sparse that both levels have all the cells that they may have
    grid = HierarchicalGrid(radii, box)
    grid.close_pairs(positions)
    assert levels_of(grid) == [10, 600]
    assert_levels_are_of_their_bodies(grid)
