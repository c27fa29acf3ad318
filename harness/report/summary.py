"""The findings as Markdown, for a README or a merge request."""

from __future__ import annotations

import re
from collections.abc import Sequence

from markupsafe import escape

from harness.report.experiment import ExperimentPage
from harness.report.machine import machine_text
from harness.report.results import Results
from harness.report.stability.case import is_case
from harness.report.words import verdicts_text


def summary(results: Results) -> str:
    """A table with a row an experiment: its title, what was found, and what became of its claims.

    Above it stand machine, versions and command of the newest sweep, and what to use at which accuracy; below it how
    far each method survives stiff and extreme scenes, whose experiments have no rows of their own.
    """
    pages = results.pages
    if not pages:
        return "There are no results yet.\n"
    newest = max((page.record.sweep for page in pages), key=lambda sweep: sweep.id)
    head = (
        f"Measured by `{newest.command}` (harness {newest.version}, {newest.started[:10]}) "
        f"on {machine_text(newest.machine)}."
    )
    rows = [
        f"| {_cell(page.record.title)} | {_cell(page.findings.answer)} | {_claims(page)} |"
        for page in pages
        if not is_case(page)
    ]
    table = ["", "| experiment | what was found | claims |", "|---|---|---|", *rows] if rows else []
    decisions = [sentence for accuracy in results.accuracy for sentence in accuracy.decisions]
    stability = results.stability.sentences if results.stability else ()
    lines = [head, *_list("What to use", decisions), *table, *_list("Stiff and extreme scenes", stability)]
    return "\n".join(lines) + "\n"


def _list(title: str, sentences: Sequence[str]) -> list[str]:
    return ["", f"**{title}**", "", *(f"- {_cell(sentence)}" for sentence in sentences)] if sentences else []


def _claims(page: ExperimentPage) -> str:
    return verdicts_text(row.verdict for row in page.record.claims)


def _cell(text: str) -> str:
    """Text or markup of a page as an entry of a Markdown table; Markdown has no raised text of its own."""
    kept = re.sub(r"<(?!/?sup>)[^>]+>", "", re.sub(r"</?strong>", "**", str(escape(text))))
    return kept.replace("|", "\\|").replace("\n", " ")
