"""Which rows of the run table belong together: chosen by leaf values, grouped by the leaves that vary."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas as pd

_SAME = 1e-9  # relative: numbers of a file and of a run that mean the same


def matching(table: pd.DataFrame, where: Mapping[str, Any]) -> pd.DataFrame:
    """The rows whose leaves have these values, or one of these where there is a list.

    >>> import pandas as pd
    >>> table = pd.DataFrame({"count": [5, 5, 50], "algorithm": ["grid", "tree", "grid"]})
    >>> matching(table, {"count": 5, "algorithm": ["grid", "tree"]}).index.tolist()
    [0, 1]
    """
    chosen: pd.DataFrame = table.loc[which(table, where)] if where else table
    return chosen


class Columns:
    """The columns of a table as JSON has their values, each made when it is first asked for: for many questions."""

    def __init__(self, table: pd.DataFrame) -> None:
        self._table = table
        self._made: dict[str, list[Any]] = {}

    def __len__(self) -> int:
        return len(self._table)

    def __contains__(self, leaf: str) -> bool:
        return leaf in self._table

    def __getitem__(self, leaf: str) -> list[Any]:
        if leaf not in self._made:
            self._made[leaf] = [plain(value) for value in self._table[leaf].tolist()]
        return self._made[leaf]


def which(table: pd.DataFrame | Columns, where: Mapping[str, Any]) -> npt.NDArray[np.bool_]:
    """Of every row, whether it is one of those."""
    columns = table if isinstance(table, Columns) else Columns(table)
    mask = np.ones(len(columns), np.bool_)
    for leaf, wanted in where.items():
        if leaf not in columns:
            mask[:] = False
            continue
        known: dict[Any, bool] = {}  # by type too: 1 is not true
        found = []
        for value in columns[leaf]:
            key = type(value), value
            if key not in known:
                known[key] = _is(value, wanted)
            found.append(known[key])
        mask &= np.array(found, np.bool_)
    return mask


def varying(table: pd.DataFrame, swept: Sequence[str]) -> list[str]:
    """The swept leaves that have more than one value in these rows."""
    return [leaf for leaf in swept if table[leaf].nunique(dropna=False) > 1]


def tied(table: pd.DataFrame, leaf: str, to: str, swept: Sequence[str]) -> bool:
    """Whether a swept leaf varies together with another leaf, as the lists of one `zip` block do.

    A derived leaf, which is not swept, is tied to every leaf that settles it, as a mesh settles its faces.
    """
    from pandas.api.types import is_numeric_dtype

    pairs = table[[leaf, to]].drop_duplicates()
    follows, settles = not pairs[to].duplicated().any(), not pairs[leaf].duplicated().any()
    if to not in swept:
        return bool(settles)
    # The lists of a zip block may repeat a number; a name that repeats is a method with points of its own
    return bool(follows and (settles or is_numeric_dtype(table[leaf])))


def grouped(table: pd.DataFrame, leaves: Sequence[str]) -> Iterator[tuple[dict[str, Any], pd.DataFrame]]:
    """Each combination of values of these leaves, and its rows."""
    if table.empty or not leaves:
        yield from [] if table.empty else [({}, table)]
        return
    for _, rows in table.groupby(list(leaves), sort=False, dropna=False):
        yield values(rows, leaves), rows


def values(rows: pd.DataFrame, leaves: Sequence[str]) -> dict[str, Any]:
    """The leaves of the first row, as JSON has them."""
    return {leaf: plain(rows[leaf].iloc[0]) for leaf in leaves}


def plain(value: Any) -> Any:
    """A value of the table as JSON has it; None for what is absent, not a number or infinite.

    >>> plain(np.int64(5)), plain(float("nan")), plain("grid")
    (5, None, 'grid')
    """
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _is(value: Any, wanted: Any) -> bool:
    value = plain(value)
    if isinstance(wanted, list | tuple):  # several choices, or one leaf that is a list
        return bool(value == json.dumps(list(wanted))) or any(_is(value, choice) for choice in wanted)
    if isinstance(wanted, Mapping):
        return bool(value == json.dumps(dict(wanted)))
    if _is_number(wanted) and _is_number(value):
        return math.isclose(value, wanted, rel_tol=_SAME)
    return type(value) is type(wanted) and bool(value == wanted)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
