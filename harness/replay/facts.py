"""The facts beside a replay: the leaves of its run, and its counters."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from harness.replay.document import Fact

_LEAVES = (
    "backend", "algorithm", "query", "within", "shape", "mesh", "count", "size", "speed", "spin", "packing",
    "box_ratio", "box", "response", "restitution", "overlap", "duration", "dt", "seed",
)  # fmt: skip
_COUNTERS = ("pair_hits", "box_hits", "pair_tests", "narrow_tests", "box_tests", "predictions")
_THIN = "\u202f"


def facts(parameters: Mapping[str, Any], metrics: Mapping[str, float]) -> list[Fact]:
    """Names and values, for people.

    Parameters
    ----------
    parameters : leaves of the point
    metrics : of its run; its counters are told
    """
    found = [(name, _said(parameters[name])) for name in _LEAVES if parameters.get(name) is not None]
    return found + [(name, f"{metrics[name]:,.0f}".replace(",", _THIN)) for name in _COUNTERS if name in metrics]


def _said(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    return value if isinstance(value, str) else json.dumps(value).translate({ord(sign): None for sign in '{}"'})
