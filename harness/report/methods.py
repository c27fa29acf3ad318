"""The methods that the runs of a table are of, and what they are called on the pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from harness.measure.selection import plain
from harness.report.point import METHOD
from harness.report.words import leaf_label
from harness.vocabulary import MethodName

_LEAVES = ("backend", "algorithm", "shape", "query")
_NAMING = {METHOD, "backend", "algorithm"}


def methods_of(runs: pd.DataFrame) -> list[MethodName]:
    """The method of every row of a run table, in its order."""
    leaves = [leaf for leaf in _LEAVES if leaf in runs.columns]
    rows = runs[leaves].itertuples(index=False, name=None)
    return [MethodName.of(dict(zip(leaves, map(plain, row), strict=True))) for row in rows]


def method_label(parameters: Mapping[str, Any], leaves: Sequence[str]) -> str:
    """What a point is called after some of its leaves: those that name a backend or an algorithm tell who did the work.

    >>> method_label({"backend": "fcl", "algorithm": "grid", "shape": "hull", "count": 9}, ["algorithm", "shape"])
    'own grid\xa0· shape hull'
    """
    named = MethodName.of(parameters).label if _NAMING & set(leaves) else ""
    others = [leaf for leaf in leaves if leaf not in _NAMING]
    words = [named] if named else []
    return "\u00a0· ".join([*words, *(leaf_label(leaf, parameters.get(leaf)) for leaf in others)])
