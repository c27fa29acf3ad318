"""A backend that crashes now and then costs those runs only, and little time."""

import pytest

from tests.runner.thousand_runs import sweep


@pytest.mark.slow
def test_a_segfault_on_every_tenth_run_leaves_nine_of_ten_results_and_rows_that_say_so(tmp_path):
    """A short form of the script `thousand_runs.py`."""
    took, rows = sweep(tmp_path, 50)
    assert rows == {("ok", None): 45, ("crashed", "ended by signal 11 (SIGSEGV)"): 5}
    assert took < 20 + 50 * 0.2  # on a machine that does much else
