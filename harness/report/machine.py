"""A machine, for people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from harness.report.quantity import plural, quantity


def machine_text(facts: Mapping[str, Any]) -> str:
    """The machine in a phrase."""
    parts = [str(facts[name]) for name in ("host", "processor") if facts.get(name)]
    parts += [plural(int(facts["cores"]), "core")] if isinstance(facts.get("cores"), int) else []
    return ", ".join(parts) or "an unknown machine"


def machine_rows(facts: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The facts of a machine by name."""
    rows = []
    for name, value in facts.items():
        if isinstance(value, int | float) and name == "memory":
            rows.append((name, quantity(float(value), "B")))
        else:
            rows.append((name, value if isinstance(value, str) else json.dumps(value)))
    return rows
