"""The form beside the map in a real browser, and figures in the forms that can be downloaded."""

import pytest

from harness.report.site import write_report
from tests.browser.test_pages import violations
from tests.report.conftest import write
from tests.report.test_map import invented

pytestmark = [pytest.mark.xdist_group("browser"), pytest.mark.slow]


@pytest.fixture(scope="module")
def overview(tmp_path_factory):
    """The overview of a report with a map of spheres: two numbers of bodies, two packings, two steps."""
    folder = tmp_path_factory.mktemp("map")
    return write_report(
        write(folder / "results.db", [invented(dt=[1 / 60, 1 / 1000])]), folder / "pages", ("pdf", "png")
    )


def test_a_scene_is_answered_from_the_nearest_measured_field_which_is_named(visit, overview):
    seen = visit(overview.as_uri())
    form = seen.page.locator("form.finder")
    answer = form.locator(".answer")

    def ask(count, packing, accuracy):
        form.locator("[name=x]").fill(count)
        form.locator("[name=y]").fill(packing)
        form.locator("[name=accuracy]").select_option(label=accuracy)
        return answer.inner_text()

    exact = ask("100", "0.05", "0.001")
    assert "own grid" in exact
    assert "algorithm: grid" in exact
    assert "motion: {dt: 0.001}" in exact
    assert "Measured there: 100 bodies, packing 0.05." in exact
    near = ask("80", "0.19", "1/60")
    assert "fcl brute-force" in near  # the grid is faster there, and wrong
    assert "Nearest measured point, nothing in between is guessed: 100 bodies, packing 0.2." in near
    assert ask("", "0.1", "1/60") == "Give two numbers."
    assert not seen.errors
    assert not violations(seen.page)


def test_without_a_script_the_fields_stand_in_a_table(visit, overview):
    page = visit(overview.as_uri(), java_script_enabled=False).page
    assert not page.locator("form.finder").is_visible()
    page.locator("summary", has_text="cells as a table").click()
    assert page.locator("#cells tbody tr").count() == 8
    assert page.locator("#cells tbody tr").first.is_visible()


def test_every_field_of_the_map_has_its_letter_so_that_nothing_hangs_on_colour_and_print_has_no_form(visit, overview):
    page = visit(overview.as_uri()).page
    letters = page.locator("#figure-map .plot.wide svg text").all_text_contents()
    assert sum(text in ("G", "B") for text in letters) >= 8
    page.emulate_media(media="print")
    assert not page.locator("form.finder").is_visible()
    assert page.locator("#figure-map .plot.wide svg").is_visible()


def test_the_figures_lie_beside_the_pages_in_every_format(visit, overview):
    for link in visit(overview.as_uri()).page.locator("a[download][href$='.svg']").all():
        for ending in (".svg", ".pdf", ".png"):
            assert (overview.parent / str(link.get_attribute("href")).replace(".svg", ending)).stat().st_size > 100
