"""A few of the scenes of several meshes that `mixed_scenes` draws."""

import pytest

from tests.methods.mixed_scenes import JUDGED, check


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_methods_and_the_judge_agree_on_scenes_of_3_to_8_meshes(shape):
    for seed in range(4):
        pairs, asked = check(shape, seed)
        assert pairs > 5
        assert asked == JUDGED
