"""The one document that a command with --json prints."""

from __future__ import annotations

import json
import math
import sys
from typing import Any

from harness.cli.streams import speaks_unicode


def json_text(document: Any) -> str:
    """A document for standard output. JSON has neither infinity nor NaN: such a number is null.

    >>> json_text({"median": float("inf"), "repeats": 5})
    '{"median": null, "repeats": 5}'
    """
    return json.dumps(_finite(document), ensure_ascii=not speaks_unicode(sys.stdout), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    return [_finite(each) for each in value] if isinstance(value, list | tuple) else value
