"""The methods that the runs of a table are of, and what they are called on the pages."""

from __future__ import annotations

import pandas as pd

from harness.measure.selection import plain
from harness.vocabulary import MethodName

_LEAVES = ("backend", "algorithm", "shape", "query")


def methods_of(runs: pd.DataFrame) -> list[MethodName]:
    """The method of every row of a run table, in its order."""
    leaves = [leaf for leaf in _LEAVES if leaf in runs.columns]
    rows = runs[leaves].itertuples(index=False, name=None)
    return [MethodName.of(dict(zip(leaves, map(plain, row), strict=True))) for row in rows]


def label_of(method: MethodName) -> str:
    """What a method is called beside others of its shape: "predictive", "grid (fcl)"."""
    # what computes events itself asks the backend nothing
    return f"{method.algorithm} ({method.backend})" if method.stepped else method.algorithm
