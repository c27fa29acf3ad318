"""The report as files: an overview, a page an experiment with its data beside it, and whatever other pages there are.

The same results give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from harness.errors import InputError
from harness.report.drawing.canvas import FileFormat
from harness.report.experiment import ExperimentPage, csv
from harness.report.markup import render as rendered
from harness.report.markup import script
from harness.report.missing import missing_runs
from harness.report.navigation import OVERVIEW, Navigation, navigation
from harness.report.overview import Overview
from harness.report.page import pages_of
from harness.report.results import Results
from harness.report.section import sections_of
from harness.report.summary import summary
from harness.store.history import at_one_moment
from harness.store.records import ExperimentRecord
from harness.whole_file import write_whole


def write_report(database: str | Path, out: str | Path, formats: Sequence[FileFormat] = ()) -> Path:
    """Write the pages of a results file, and return the overview's path.

    Files that the report does not make are left alone.

    Parameters
    ----------
    database : the results file; it is only read
    out : folder of the pages, made where it is missing
    formats : in which figures are written beside their SVG

    Raises
    ------
    InputError
        The results file cannot be read, or the folder cannot be written to.
    """
    out = Path(out)
    with at_one_moment(database):
        contents = list(render(database, formats))  # all of it or, where something is wrong, nothing
    try:
        for name, text in contents:
            write_whole(out / name, text)
    except OSError as error:
        raise InputError(
            f"{error.filename or out}: cannot be written: {error.strerror}; give another folder with --out"
        ) from error
    return out / OVERVIEW


def render(database: str | Path, formats: Sequence[FileFormat] = ()) -> Iterator[tuple[str, Any]]:
    """Every file of the report: (path below the report, text; of a figure in another format, its bytes)."""
    results = Results(database)
    missing = missing_runs(results.records, results.runs)
    overview, further = Overview(results), pages_of(results)
    written = sections_of("overview", overview) if results.pages else []
    links = navigation([found.section for found in written], [page for page, _ in further])
    for page in results.pages:
        yield from _experiment(page, links)
        for figures in page.figures.values():
            for figure in figures:
                yield from ((f"{page.folder}/{name}", data) for name, data in map(figure.as_file, formats))
    yield (
        OVERVIEW,
        rendered(
            "index.html.j2",
            title="Overview · harness",
            root="",
            navigation=links.on(OVERVIEW),
            overview=overview,
            sections=written,
            footer=_footer(results.records),
            missing=missing,
        ),
    )
    if overview.map_figure is not None:
        yield overview.map_figure.file, overview.map_figure.document
        yield from map(overview.map_figure.as_file, formats)
    for other, content in further:
        yield (
            other.file,
            rendered(
                content.template,
                title=f"{other.title} · harness",
                root="",
                navigation=links.on(other.file),
                footer=_footer(content.records),
                missing=missing,
                **content.values,
            ),
        )
        for figure in content.figures:
            yield figure.file, figure.document
            yield from map(figure.as_file, formats)
        yield from content.files.items()
    yield "report.js", script()
    yield "findings.md", summary(results)
    yield "runs.csv", csv(results.runs)


def _experiment(page: ExperimentPage, links: Navigation) -> Iterator[tuple[str, str]]:
    text = rendered(
        "experiment.html.j2",
        title=f"{page.record.title} · harness",
        root=page.up,
        navigation=links.on_experiment(page),
        page=page,
        sections=sections_of("experiment", page),
        footer=_footer([page.record]),
        missing=missing_runs([page.record], page.runs),
    )
    yield f"{page.folder}/index.html", text
    if page.replay is not None:
        yield f"{page.folder}/{page.replay.file}", page.replay.page
    yield f"{page.folder}/runs.csv", page.csv
    yield f"{page.folder}/specification.yaml", page.record.source
    yield f"{page.folder}/environment.json", json.dumps(page.environment, indent=2, ensure_ascii=False) + "\n"
    for figures in page.figures.values():
        yield from ((f"{page.folder}/{figure.file}", figure.document) for figure in figures)


def _footer(records: Sequence[ExperimentRecord]) -> Markup:
    """Where the pages come from: all of it from the results, so that the same results give the same page."""
    if not records:
        return Markup("Made by <code>harness report</code>")
    newest = max((record.sweep for record in records), key=lambda sweep: sweep.id)
    commit = Markup(" · commit <code>{}</code>").format(newest.commit[:12]) if newest.commit else Markup("")
    return Markup("Made by <code>harness report</code> · swept {} with harness {}{}").format(
        newest.started, newest.version, commit
    )
