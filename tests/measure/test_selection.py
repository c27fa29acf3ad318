"""Rows chosen by the values of their leaves, whatever kinds of values stand in one column."""

import numpy as np
import pandas as pd
import pytest

from harness.measure.selection import Columns, which

TABLE = pd.DataFrame(
    {
        "count": [5, 5, 50],
        "algorithm": ["grid", None, "tree"],
        "mixed": [1, True, 1.0],
        "box": ["[9, 9, 9]", "[9, 9, 8]", None],
    }
)


@pytest.mark.parametrize(
    ("where", "expected"),
    [
        ({}, [True, True, True]),
        ({"count": 5.0}, [True, True, False]),
        ({"count": [5, 50], "algorithm": "grid"}, [True, False, False]),
        ({"algorithm": None}, [False, True, False]),
        ({"mixed": 1}, [True, False, True]),  # equal to true, and no truth value
        ({"mixed": True}, [False, True, False]),
        ({"box": [9, 9, 9]}, [True, False, False]),
        ({"nothing": 5}, [False, False, False]),
    ],
)
def test_a_table_and_its_columns_give_the_same_rows(where, expected):
    columns = Columns(TABLE)
    for table in (TABLE, columns, columns):
        assert np.array_equal(which(table, where), expected)
