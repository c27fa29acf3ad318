"""Poses and sets of cases damaged at random; `fuzz_files.py` tries more of them."""

import warnings

import pytest

from tests.runner.fuzz_files import KINDS_OF_FILES, fuzz


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS_OF_FILES)
def test_what_is_damaged_deep_inside_is_read_or_refused_in_a_persons_words(kind):
    with warnings.catch_warnings():
        outcomes, failures = fuzz(KINDS_OF_FILES[kind], 150, seed=259)
    assert failures == []
    assert outcomes["read"] > 0
    assert outcomes["refused"] > 50
