import pytest

from harness.scene.formats import FORMATS
from tests.scene.fuzz_meshes import fuzz


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMATS)
def test_changed_files_are_read_or_refused_in_plain_words(form):
    """A short form of the script `fuzz_meshes.py`."""
    tally = fuzz(form, 60)
    assert tally.failures == []
    assert tally.outcomes["read"] + tally.outcomes["refused"] == 60
    assert tally.outcomes["read"] > 5
