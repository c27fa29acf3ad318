"""The table of all points in a real browser: filtered, arranged, grouped, kept in the address and saved."""

import csv
from urllib.parse import parse_qs

import pytest

from tests.browser.test_pages import violations

pytestmark = pytest.mark.xdist_group("browser")

VISIBLE = """() => [...document.querySelectorAll("table.explored tbody tr:not(.group)")].map((row) =>
  [...row.cells].filter((cell) => cell.offsetParent).map((cell) => cell.textContent.replace(/\\u202f/g, "")))"""
HEADINGS = """() => [...document.querySelectorAll("table.explored thead th")].filter((cell) => cell.offsetParent)
  .map((cell) => cell.dataset.name)"""


@pytest.fixture
def points(visit, report):
    def opened(state="", **options):
        return visit((report / "points.html").as_uri() + state, **options)

    return opened


def column(page, name):
    """What is shown below a heading."""
    place = page.evaluate(HEADINGS).index(name)
    return [row[place] for row in page.evaluate(VISIBLE)]


def state_of(page):
    return parse_qs(page.evaluate("location.hash.slice(1)"), keep_blank_values=True)


def saved(page, button):
    with page.expect_download() as download:
        page.get_by_role("button", name=button).click()
    return download.value.path()


@pytest.mark.slow
def test_a_filter_leaves_rows_of_its_values_and_the_address_shows_them_again(points):
    seen = points()
    page = seen.page
    everything = len(page.evaluate(VISIBLE))
    page.locator("summary", has_text="experiment").click()
    page.get_by_label("homework/algorithms").check()
    assert len(page.evaluate(VISIBLE)) == 45
    page.locator("summary", has_text="algorithm").nth(1).click()
    page.get_by_label("grid", exact=True).check()
    page.get_by_label("predictive", exact=True).check()
    assert len(page.evaluate(VISIBLE)) == 30
    count = page.locator("details", has=page.locator("summary", has_text="count"))
    count.locator("summary").click()
    count.get_by_label("from").fill("10")
    count.get_by_label("to").fill("30")
    count.get_by_label("to").blur()
    assert sorted(set(column(page, "count"))) == ["10", "30"]
    assert page.locator("form.explore output").inner_text() == f"12 of {everything} points"
    wanted = {"experiment": ["homework/algorithms"], "algorithm": ["grid", "predictive"], "count": ["10..30"]}
    assert state_of(page) == wanted
    again = points("#" + page.evaluate("location.hash.slice(1)"))
    assert again.page.evaluate(VISIBLE) == page.evaluate(VISIBLE)
    page.get_by_role("button", name="Show all").click()
    assert len(page.evaluate(VISIBLE)) == everything
    assert not state_of(page)
    assert not seen.errors


@pytest.mark.slow
def test_rows_are_sorted_by_exact_values_and_grouped_with_their_medians(points):
    page = points("#experiment=homework%2Falgorithms&count=10..100&columns=algorithm,count,pair_tests").page
    assert page.evaluate(HEADINGS) == ["experiment", "algorithm", "count", "pair_tests"]
    for down in (False, True):
        page.get_by_role("button", name="object/object tests").click()
        tests = [int(text) for text in column(page, "pair_tests")]
        assert tests == sorted(tests, reverse=down)
    assert state_of(page)["sort"] == ["-pair_tests"]
    heading = page.locator("th[data-name=count]")
    edge = heading.bounding_box()
    heading.click(position={"x": 3, "y": edge["height"] - 3})  # beside its text
    assert state_of(page)["sort"] == ["count"]
    page.locator("th[data-name=pair_tests]").get_by_role("button").press("Enter")  # without a pointer
    assert state_of(page)["sort"] == ["pair_tests"]
    page.get_by_label("Group by").select_option("count")
    groups = page.locator("tr.group").all_inner_texts()
    frames = 600  # 10 s of 1/60 s
    assert [text.replace("\u202f", "").split() for text in groups] == [
        [f"{count}:", "9", str(frames * count * (count - 1) // 2)] for count in (10, 30, 100)
    ]
    assert state_of(page)["group"] == ["count"]


@pytest.mark.slow
def test_what_is_saved_is_what_is_shown_with_exact_numbers(points, report):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed: pip install '.[dev]'")
    page = points(
        "#experiment=backends&experiment=broken&columns=backend,mesh,count,run_seconds&sort=-run_seconds"
    ).page
    with saved(page, "CSV").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    table = parquet.read_table(saved(page, "Parquet"))
    assert list(rows[0]) == table.column_names == ["experiment", "backend", "count", "mesh", "run_seconds"]
    assert len(rows) == table.num_rows == len(page.evaluate(VISIBLE)) == 8
    for written, read in zip(rows, table.to_pylist(), strict=True):
        assert {name: "" if value is None else str(value) for name, value in read.items()} == {
            name: text if name != "count" else f"{float(text)}" for name, text in written.items()
        }
    with (report / "runs.csv").open(encoding="utf-8", newline="") as file:
        runs = [row for row in csv.DictReader(file) if row["experiment"] == "backends" and row["backend"] == "fcl"]
    duck = sorted(float(run["run_seconds"]) for run in runs if run["mesh"] == "duck.obj")
    [median] = [row["run_seconds"] for row in rows if (row["backend"], row["mesh"]) == ("fcl", "duck.obj")]
    assert float(median) == duck[2]
    assert [row["run_seconds"] for row in rows if row["experiment"] == "broken"] == ["", ""]


@pytest.mark.slow
def test_all_rows_and_columns_are_there_without_a_script(points):
    with_script = points()
    without = points(java_script_enabled=False).page
    lines = without.locator("table.explored tbody tr")
    assert lines.count() == len(with_script.page.evaluate(VISIBLE))
    assert not without.locator("form.explore").is_visible()
    assert without.locator("table.explored thead th", has_text="memory").is_visible()


@pytest.mark.slow
def test_the_form_is_accessible_with_everything_open(points):
    page = points("#experiment=homework%2Falgorithms&group=algorithm&sort=-run_seconds").page
    page.evaluate("document.querySelectorAll('form.explore details').forEach((one) => { one.open = true; })")
    assert not violations(page)


@pytest.mark.slow
def test_the_page_of_an_experiment_leads_to_its_points(visit, report):
    page = visit((report / "pages" / "homework" / "algorithms" / "index.html").as_uri()).page
    page.get_by_role("link", name="All its points in one table").click()
    assert page.locator("form.explore output").inner_text().startswith("45 of ")
    assert set(column(page, "experiment")) == {"homework/algorithms"}
