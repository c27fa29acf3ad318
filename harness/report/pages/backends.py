"""Backends compared on the same poses: who is right, proven, and what does being right cost?"""

from __future__ import annotations

from harness.report.backends import tables
from harness.report.backends.cases import shown_cases
from harness.report.backends.correctness import correctness
from harness.report.backends.speeds import speed_table
from harness.report.backends.summary import summary
from harness.report.figure import figures_of
from harness.report.page import Content, Page
from harness.report.results import Results


def _content(results: Results) -> Content | None:
    compared = results.compared.of_two
    if not compared.records:
        return None
    known = correctness(results.compared.records)
    names = {record.experiment for record in compared.records}
    pages = sorted((page for page in results.pages if page.record.name in names), key=lambda page: page.record.name)
    speeds = [table for page in pages if (table := speed_table(page, known)) is not None]
    figures, cases = figures_of("backends", compared), shown_cases(compared)
    approximations, flights = tables.approximations(compared), tables.flights(compared)
    contents = (
        ("matrix", "Matrix", True),
        ("gaps", "Gaps", bool(figures["gaps"])),
        ("cases", "Proven wrong", bool(cases)),
        ("approximations", "Approximations", approximations is not None),
        ("flights", "In flight", flights is not None),
        ("speed", "Speed", bool(speeds)),
        ("reading", "How to read", True),
    )
    values = {
        "contents": [(identity, title) for identity, title, there in contents if there],
        "compared": compared,
        "summary": summary(compared),
        "matrix": tables.agreement(compared),
        "by_experiment": tables.by_experiment(compared),
        "gaps": figures["gaps"],
        "cases": list(zip(cases, figures["cases"], strict=True)),
        "approximations": approximations,
        "flights": flights,
        "speeds": speeds,
    }
    return Content(
        "backends.html.j2",
        values,
        results.records,
        [figure for found in figures.values() for figure in found],
        {case.file: case.text for case in cases if case.text},
    )


PAGE = Page("backends.html", "Backends", 20, _content)
