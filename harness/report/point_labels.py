"""What tells a point from the others of its experiment."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping
from typing import Any

from harness.measure.metrics import DERIVED
from harness.report.words import leaf_label


def labels_of(points: Mapping[str, tuple[str, Mapping[str, Any]]]) -> dict[str, str]:
    """By the key of each point the leaves that differ among those of its experiment; "" where none does.

    Parameters
    ----------
    points : by key, the name of the experiment and the parameters

    >>> labels_of({"a": ("x", {"count": 2, "dt": 1.0}), "b": ("x", {"count": 3, "dt": 1.0}), "c": ("y", {"count": 2})})
    {'a': 'count 2', 'b': 'count 3', 'c': ''}
    """
    keys_of: dict[str, list[str]] = defaultdict(list)
    for key, (experiment, _) in points.items():
        keys_of[experiment].append(key)
    labels: dict[str, str] = {}
    for keys in keys_of.values():
        parameters = {key: points[key][1] for key in keys}
        leaves = dict.fromkeys(leaf for found in parameters.values() for leaf in found if leaf not in DERIVED)
        differing = [
            leaf
            for leaf in leaves
            if len({json.dumps(found.get(leaf), sort_keys=True) for found in parameters.values()}) > 1
        ]
        for key, found in parameters.items():
            labels[key] = ", ".join(leaf_label(leaf, found.get(leaf)) for leaf in differing)
    return labels
