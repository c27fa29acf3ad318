"""Verdicts of expectations or claims, as a section of a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from markupsafe import Markup

from harness.report.markup import render
from harness.report.words import in_words, leaf_label
from harness.store.records import VerdictRow


def worded(row: VerdictRow) -> VerdictRow:
    """The verdict with its metric in words, here and in each of its groups."""
    metric = str(row.criterion.get("metric", ""))
    groups = [
        {**group, "statement": in_words(str(group.get("statement", "")), metric)}
        for group in row.detail.get("groups") or []
    ]
    return replace(row, statement=in_words(row.statement, metric), detail={**row.detail, "groups": groups})


def verdicts_html(identity: str, title: str, rows: Sequence[VerdictRow]) -> Markup:
    """A section with a verdict each and the groups that it stands on; empty without verdicts."""
    if not rows:
        return Markup()
    found = [(row, _groups(row.detail)) for row in rows]
    return render("experiment/verdicts.html.j2", identity=identity, title=title, rows=found)


def _groups(detail: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """(which, verdict, statement) of every group; none where there is only one."""
    groups = detail.get("groups") or []
    rows = []
    for group in groups if len(groups) > 1 else ():
        which = ", ".join(leaf_label(leaf, value) for leaf, value in group.get("parameters", {}).items())
        rows.append((which or "all points", str(group.get("verdict", "")), str(group.get("statement", ""))))
    return rows
