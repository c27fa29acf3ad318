"""What a newcomer adds is one file and nothing else: tried on a copy of the program, with its own commands.

The copy gets a metric, a figure, a section of each page that has some, and a page; a tiny experiment is swept and
reported, and all of it must be there.
"""

import json

import pytest

from tests.program_copy import ProgramCopy

pytestmark = pytest.mark.slow

EXPERIMENT = """
title: Tiny
scene: {shape: sphere, box: [3, 3, 3], count: 4}
motion: {duration: 2, dt: 1/5}
sweep: {count: [3, 4]}
measure: {repeats: 1}
expect: [{metric: free_share, at_least: 0.5}]
report: {x: count, y: [free_share]}
"""
FILES = {
    "measure/metrics/crowding.py": '''
"""How much of the box is free."""

from math import pi

from harness.measure.metric import Metric


def _free_share(scene, outcome):
    spheres = pi / 6 * (scene.bodies.sizes**3).sum()
    return 1 - spheres / scene.box.sides.prod() if outcome.metrics["frames"] else None


METRICS = (
    Metric("free_share", "1", "physics", "volume outside of all bodies / volume of the box", measure=_free_share),
    Metric("unheard_of", "1", "error", "never measured", measure=lambda scene, outcome: None),
)
''',
    "report/figures/experiment/walls.py": '''
"""Wall hits against x."""

from harness.report.drawing.panels import Line, Panel, draw_panels
from harness.report.figure import Figure, FigureSource


def _figures(page):
    (series,) = page.arrangement.series
    line = Line("wall hits", 0, tuple(map(float, series.x)), tuple(p.median("box_hits") for p in series.points))
    panel = Panel("", "number of bodies", "wall hits", (line,))
    yield Figure("walls", "Wall hits", "Wall hits against the number of bodies, a line.", "Exact.",
                 lambda form, name: draw_panels([panel], form, name))


SOURCE = FigureSource(_figures)
''',
    "report/sections/experiment/greeting.py": '''
"""A paragraph between the results and the failures."""

from harness.report.markup import section_html
from harness.report.section import Section

SECTION = Section("greeting", "Greeting", 45, lambda page: section_html("greeting", "A greeting", page.record.title))
''',
    "report/sections/overview/farewell.py": '''
"""The last word of the overview."""

from harness.report.markup import section_html
from harness.report.section import Section

SECTION = Section("farewell", "Farewell", 99, lambda overview: section_html("farewell", "Farewell", overview.totals))
''',
    "report/pages/about.py": '''
"""A page that has no template of its own."""

from harness.report.page import Content, Page


def _content(results):
    return Content("index.html.j2", {"overview": {"results": {"pages": []}}, "sections": []}, results.records)


PAGE = Page("about.html", "About", 99, _content)
''',
}


@pytest.fixture(scope="module")
def harness(tmp_path_factory):
    """Runs a command of the copy, which has the new files, and returns what it prints."""
    program = ProgramCopy(tmp_path_factory.mktemp("program"), compiled=False)
    for name, text in FILES.items():
        program.add(f"harness/{name}", text)
    program.add("tiny.yaml", EXPERIMENT)
    return program.run


@pytest.fixture(scope="module")
def pages(harness, tmp_path_factory):
    """The report of the experiment, by path."""
    out = tmp_path_factory.mktemp("report")
    harness("sweep", "tiny.yaml", "--db", str(out / "results.db"), "--quiet")
    harness("report", "--db", str(out / "results.db"), "--out", str(out))
    return {str(path.relative_to(out)): path.read_text() for path in out.rglob("*") if path.suffix in (".html", ".svg")}


def test_a_metric_is_listed_measured_expected_drawn_and_tabulated(harness, pages):
    listed = {row["name"]: row for row in json.loads(harness("list", "--json"))["metrics"]}
    assert listed["free_share"]["description"] == "volume outside of all bodies / volume of the box"
    page = pages["pages/tiny/index.html"]
    assert "What was expected holds: 1\u00a0expectation." in page
    assert "Free share against number of bodies" in page
    assert '<th scope="col" class="n" data-sort>Free share</th>' in page
    assert "0.942" in page  # 1 - 3 π/6 / 27
    assert "Unheard of" not in page


def test_a_figure_stands_on_the_page_and_can_be_had_as_a_file(pages):
    page = pages["pages/tiny/index.html"]
    assert '<h2>Wall hits</h2>\n<figure id="figure-walls">' in page
    assert '<a href="walls.svg" download>' in page
    assert "pages/tiny/walls.svg" in pages


def test_a_section_stands_in_its_place_and_in_the_list_of_contents(pages):
    page = pages["pages/tiny/index.html"]
    assert '<a href="#results">Results</a>\n<a href="#greeting">Greeting</a>' in page
    assert page.index('id="results"') < page.index('<section id="greeting"><h2>A greeting</h2>\n<p>Tiny</p>')
    assert page.index('id="greeting"') < page.index('id="plan"')


def test_a_section_of_the_overview_is_in_the_navigation_of_every_page(pages):
    assert '<section id="farewell"><h2>Farewell</h2>' in pages["index.html"]
    assert '<a href="index.html#farewell">Farewell</a>' in pages["index.html"]
    assert '<a href="../../index.html#farewell">Farewell</a>' in pages["pages/tiny/index.html"]


def test_a_page_is_written_and_in_the_navigation_of_every_page(pages):
    assert '<a aria-current="page">About</a>' in pages["about.html"]
    assert '<a href="about.html">About</a>' in pages["index.html"]
    assert '<a href="../../about.html">About</a>' in pages["pages/tiny/index.html"]
