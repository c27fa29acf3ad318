"""The report as files: right, escaped, whole without a network, and the same each time."""

import argparse
import csv
import io
import json
import re
from html import unescape
from html.parser import HTMLParser

import pytest

from harness.cli import report
from harness.errors import InputError
from harness.report.site import render, write_report
from harness.store.database import Database
from harness.store.tables import experiments, runs
from tests.report.conftest import FEW, Invented, write

VOID = {"meta", "br", "img", "hr", "input", "link", "path", "rect", "use"}


def page(pages, name):
    return pages[f"pages/{name}/index.html"]


def text_of(html):
    return re.sub(r"[ \n]+", " ", re.sub(r"<[^>]+>", " ", re.sub(r"<(style|script)\b.*?</\1>", " ", html, flags=re.S)))


def html_of(pages):
    return {name: text for name, text in pages.items() if name.endswith(".html")}


class Outline(HTMLParser):
    """Checks that elements nest, and gathers ids and references."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.references = [], [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        given = dict(attrs)
        self.ids += [given["id"]] if "id" in given else []
        for name in ("aria-labelledby", "aria-describedby"):
            self.references += [given[name]] if name in given else []
        if (given.get("href") or "").startswith("#"):
            self.references.append(given["href"][1:])

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag, self.getpos()


@pytest.mark.slow
def test_every_experiment_has_a_page_and_the_overview_links_it(database, pages):
    for name in ("index.html", "experiments.html"):
        links = re.findall(r'<h[234]><a href="([^"]+)"', pages[name])
        assert len(links) == len(experiments(database))
        assert set(links) <= pages.keys()


@pytest.mark.slow
def test_the_overview_shows_few_findings_and_says_where_the_others_are(tmp_path):
    many = [Invented(f"x{place}", f"X{place}", {"count": [10, 40, 160]}, {}) for place in range(12)]
    overview = dict(render(write(tmp_path / "x.db", many)))["index.html"]
    assert overview.split('id="findings"')[1].split("</ul>")[0].count("<li>") == 5
    assert "7 more stand under their" in overview


@pytest.mark.slow
def test_pages_are_well_formed_with_unique_ids_that_references_meet(pages):
    for name, html in html_of(pages).items():
        outline = Outline()
        outline.feed(html)
        assert not outline.open, name
        assert len(set(outline.ids)) == len(outline.ids), name
        assert set(outline.references) <= set(outline.ids), name


def test_links_between_pages_meet_files(pages):
    for name, html in html_of(pages).items():
        parts = name.split("/")[:-1]
        for href in re.findall(r'href="([^"#][^"]*)"', html):
            target = href.split("#")[0].split("/")
            climbed = parts[: len(parts) - target.count("..")] + [part for part in target if part != ".."]
            assert "/".join(climbed) in pages, (name, href)


def test_pages_reach_for_nothing_outside(pages):
    for html in html_of(pages).values():
        assert not re.search(r"https?://|@import|url\(", html)
        tags = " ".join(re.findall(r"<[^>]+>", html))
        assert not re.search(r"""="//|<(link|iframe|img|object|embed)\b""", tags)
        assert re.fullmatch(r"(\.\./)*report\.js", *re.findall(r'\bsrc="(.*?)"', tags))


def test_hostile_text_stays_text(pages):
    for html in html_of(pages).values():
        assert html.count("<script") == html.count("report.js") == 1
        for hostile in ("<script>alert", "<img src=x", "<i>never", "<u>me", "<b>a</b>", "after 120 s <of>"):
            assert hostile not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in pages["index.html"]


def test_a_hostile_name_stays_inside_the_report(pages):
    assert all(re.fullmatch(r"(pages/[\w./-]+/)?[\w.-]+", name) and ".." not in name for name in pages)


@pytest.mark.slow
def test_the_same_results_give_the_same_bytes(database, pages):
    assert dict(render(database)) == pages


def test_every_figure_says_what_it_shows(pages):
    drawings = [
        svg for html in html_of(pages).values() for svg in re.findall(r"<svg (?!class|width)[^>]*>.{0,900}", html)
    ]
    assert len(drawings) > 30
    for drawing in drawings:
        assert re.match(r'<svg role="img" aria-labelledby="[^"]+" aria-describedby="[^"]+" viewBox=', drawing)
        assert re.search(r"<title id=[^>]*>[^<]{10,}</title><desc id=[^>]*>[^<]{40,}", drawing)


def test_an_experiment_page_stays_small(pages):
    assert max(len(html.encode()) for html in html_of(pages).values()) < 400_000


def test_the_table_shows_the_counts_and_rates_of_the_database(database, pages):
    table = runs(database, ["homework/number-of-objects"])
    text = text_of(page(pages, "homework/number-of-objects"))
    for _, run in table.iterrows():
        assert f"{int(run['pair_tests']):,}".replace(",", "\u202f") in text
    median = table[table["count"] == 50]["pair_seconds"].median()
    assert f"{median * 1000:,.0f}".replace(",", "\u202f") in text


def test_findings_give_exponents_with_intervals(pages):
    text = text_of(page(pages, "homework/number-of-objects"))
    found = re.search(r"object/object test time as count\s*(\S+)\s*\[(\S+), (\S+)\]", text)
    value, low, high = (float(part) for part in found.groups())
    assert 1.9 < low <= value <= high < 2.1


def test_claims_and_expectations_come_with_their_verdicts(pages):
    html = page(pages, "homework/number-of-objects")
    assert "1 holds, 1 fails, 1 undecided" in text_of(html)
    assert re.search(r"badge fails\">fails</span></span><div><p>box_seconds falls with count", html)
    assert "Expectation broken : pair_hits is 30 in 3 of 6 points" in text_of(page(pages, "backends"))
    assert "pair_hits is 30 in 3 of 6 points" in pages["index.html"]


def test_the_overview_counts_what_became_of_the_claims(pages):
    assert "Of 5\u00a0claims, 2 hold, 2 do not, 1 undecided." in text_of(pages["index.html"])


def test_failed_runs_are_shown_with_their_reasons(pages):
    html = page(pages, "homework/algorithms")
    assert "15 of 225" in text_of(html)
    assert "stopped after 120 s &lt;of&gt; CPU time" in html
    assert "signal 11" in page(pages, "broken")
    assert "10 failed" in pages["index.html"]


def test_a_mesh_that_is_a_hull_is_said_in_a_warning(pages):
    html = page(pages, "backends")
    warning = html[html.index('class="box warning"') :]
    assert "Shape mesh on backend pybullet is a hull" in warning[:400]


def test_published_numbers_stand_beside_ours_with_what_contradicts_them(pages):
    text = text_of(page(pages, "homework/number-of-objects"))
    assert "23 where 25 is printed" in text
    assert "14.44 where 15 is printed" in text
    assert "478 against 851 (count 5)" in text
    assert "Row count 40 repeats row faces 1\u202f753 of homework/complexity" in text
    ours, theirs = 600 * 25 * 24 / 2, 102718
    assert f"{ours / theirs:.2f}×" in text


def test_too_little_range_is_said_instead_of_an_exponent(pages):
    assert "not enough range: 10× in x" in page(pages, "few")


def test_three_repeats_have_a_range_and_no_interval(pages):
    text = text_of(page(pages, "few"))
    assert "too few repeats for an interval" in text
    assert "median's interval" not in text


def test_one_run_is_a_page_without_figures(pages):
    html = page(pages, "single")
    assert "<figure" not in html
    assert "one run a point, so no interval" in html.lower()


def test_the_stages_left_out_are_given_with_the_reason(pages):
    text = text_of(page(pages, "single"))
    assert re.search(r"rotations left out spheres look the same from all sides all points", text)


def test_data_lies_beside_the_pages(database, pages):
    rows = list(csv.DictReader(io.StringIO(pages["runs.csv"])))
    assert len(rows) == len(runs(database))
    folder = "pages/homework/complexity"
    assert len(list(csv.DictReader(io.StringIO(pages[f"{folder}/runs.csv"])))) == 15
    assert json.loads(pages[f"{folder}/environment.json"])["machine"]["processor"] == "Example CPU 9"
    assert pages[f"{folder}/specification.yaml"].startswith("title: Cost against the faces")
    assert 'xmlns="http://www.w3.org/2000/svg"' in pages[f"{folder}/pair_seconds.svg"]


def test_a_sweep_without_experiments_gives_an_overview_that_says_so(tmp_path):
    Database.open(tmp_path / "empty.db").close()
    pages = dict(render(tmp_path / "empty.db"))
    assert "There are no results yet" in pages["index.html"]


@pytest.fixture(scope="module")
def few(tmp_path_factory):
    """A results file with one small experiment."""
    return write(tmp_path_factory.mktemp("few") / "results.db", [FEW])


def test_the_command_writes_the_pages_and_says_where(few, tmp_path, capsys):
    parser = argparse.ArgumentParser()
    report.add_arguments(parser)
    assert report.run(parser.parse_args(["--db", str(few), "--out", str(tmp_path / "out")])) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "out" / "index.html")
    written = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert written == dict(render(few)).keys()


def test_results_that_are_not_there_and_folders_that_cannot_be_are_input_errors(few, tmp_path):
    with pytest.raises(InputError):
        write_report(tmp_path / "nothing.db", tmp_path / "out")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="--out"):
        write_report(few, tmp_path / "file")


def test_a_faster_answer_that_is_wrong_is_struck_through_and_never_ranked(report_of):
    def wrong(parameters, repeat, metrics):
        if parameters["backend"] == "pybullet":
            metrics["pair_seconds"] /= 100
            metrics["missed_hits"] = 0.5

    swept = {"count": [10, 40, 160], "backend": ["fcl", "pybullet"]}
    html = page(report_of(swept=swept, fate=wrong), "x")
    assert "3 points report hits that the reference does not" in text_of(html).replace("\u00a0", " ")
    assert html.count('<s class="struck">') > 3
    assert "has the lowest" not in html
    assert "ahead of" not in html


def test_the_fastest_is_named_with_how_far_it_is_ahead(report_of):
    def slower(parameters, repeat, metrics):
        metrics["pair_seconds"] *= 4 if parameters["backend"] == "pybullet" else 1

    swept = {"count": [10, 40, 160], "backend": ["fcl", "pybullet"]}
    text = text_of(page(report_of(swept=swept, fate=slower), "x"))
    found = re.search(
        r"For 160\sbodies[^:]*: fcl brute-force has the lowest .*?that is (\S+)× \[(\S+), (\S+)\] ahead", text
    )
    ratio, low, high = found.groups()
    assert float(low) <= float(ratio) <= float(high)
    assert 3.5 < float(ratio) < 4.5


@pytest.mark.parametrize("repeats", [1, pytest.param(3, marks=pytest.mark.slow), 4])
def test_with_fewer_than_five_repeats_nobody_is_ahead_and_the_range_is_said(report_of, repeats):
    def slower(parameters, repeat, metrics):
        metrics["pair_seconds"] *= 4 if parameters["backend"] == "pybullet" else 1

    swept = {"count": [10, 40, 160], "backend": ["fcl", "pybullet"]}
    pages = report_of(swept=swept, fate=slower, repeats=repeats)
    html = page(pages, "x")
    for text in map(text_of, (html, pages["index.html"], pages["findings.md"])):
        assert "ahead of" not in text
        assert "has the lowest" not in text
        assert "they do not cross" not in text
        assert "too few repeats to rank" in text
    assert 'class="n best"' not in html
    assert ("ms to" in text_of(html).replace("\u00a0", " ")) == (repeats > 1)


def test_without_a_control_nobody_is_ahead(report_of, monkeypatch):
    monkeypatch.setattr("tests.report.conftest.add_controls", lambda *_: None)

    def slower(parameters, repeat, metrics):
        metrics["pair_seconds"] *= 4 if parameters["backend"] == "pybullet" else 1

    html = page(report_of(swept={"count": [10, 40], "backend": ["fcl", "pybullet"]}, fate=slower), "x")
    assert "no control to rank by" in text_of(html)
    assert "ahead of" not in html
    assert 'class="n best"' not in html


def test_nothing_is_said_of_a_quantity_that_is_not_there(report_of):
    def no_walls(parameters, repeat, metrics):
        metrics["box_seconds"] = 0.0

    html = page(report_of(swept={"count": [10, 40], "backend": ["fcl", "pybullet"]}, fate=no_walls), "x")
    findings = text_of(html[html.index('id="findings"') : html.index("</section>")])
    assert "object/object test time" in findings
    assert "object/wall" not in findings


def test_the_report_links_the_page_of_how_far_to_trust_it(report_of):
    pages = report_of(swept={"count": [10, 40], "backend": ["fcl", "pybullet"]})
    assert pages["index.html"].count('href="trust.html"') == 2
    text = text_of(pages["trust.html"]).replace("\u00a0", " ")
    assert "a report of 60 experiments of equal methods names a winner" in text
    assert "This report looks at" in text


def test_a_busy_machine_is_flagged(report_of):
    def busy(parameters, repeat, metrics):
        metrics["run_seconds_elapsed"] = 2 * metrics["run_seconds"]

    html = page(report_of(fate=busy), "x")
    assert "elapsed time is more than 1.2 times the CPU time in 3 of 3" in html
    assert html.count('<span class="flag">busy</span>') == 3


def test_frames_per_second_rank_the_other_way_round(report_of):
    def slower(parameters, repeat, metrics):
        metrics["frames_per_second"] /= 4 if parameters["backend"] == "pybullet" else 1

    fields = {"swept": {"count": [10, 40], "backend": ["fcl", "pybullet"]}, "report": {"y": ["frames_per_second"]}}
    assert "fcl brute-force has the highest frames per second" in text_of(page(report_of(fate=slower, **fields), "x"))


def test_a_metric_that_no_run_reports_is_said(report_of):
    html = page(report_of(report={"y": ["position_error", "pair_seconds"]}), "x")
    assert "No run reports position_error" in html


def test_the_findings_come_as_markdown_with_a_row_an_experiment(database, pages):
    rows = [line for line in pages["findings.md"].splitlines() if line.startswith("| ")][1:]
    titles = [unescape(row.split(" | ")[0].removeprefix("| ")) for row in rows]
    assert titles == [row.title for row in experiments(database)]
    assert all(row.count(" | ") == 2 for row in rows)
    assert not re.search(r"</?(?!sup)\w+>", pages["findings.md"])


@pytest.mark.slow
def test_what_happens_in_a_scene_has_no_best(report_of):
    def luckier(parameters, repeat, metrics):
        metrics["pair_hits"] *= 4 if parameters["backend"] == "pybullet" else 1

    swept = {"count": [10, 40, 160], "backend": ["fcl", "pybullet"]}
    html = page(report_of(swept=swept, fate=luckier, report={"x": "count", "y": ["pair_hits", "pair_tests"]}), "x")
    names = ("Object/object hits", "Object/object tests")
    hits, tests = (html.split(f'aria-label="{name}">', 1)[1].split("</table>", 1)[0] for name in names)
    assert not re.search(r'class="[^"]*\b(best|t\d)\b', hits)
    assert re.search(r'class="[^"]*\bbest\b', tests)
