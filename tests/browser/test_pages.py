"""Every page of a report in a real browser: whole, without a network, readable at any width, and accessible."""

import pytest

from tests.browser.conftest import DESKTOP, PHONE

pytestmark = pytest.mark.xdist_group("browser")

# what sticks out to the right of the page without a place of its own to scroll
STICKING_OUT = """() => document.documentElement.scrollWidth > document.documentElement.clientWidth
  ? [...document.querySelectorAll("body *")].filter((e) => e.getBoundingClientRect().right > innerWidth + 1)
      .map((e) => e.outerHTML.slice(0, 120)).slice(0, 5) : []"""


# pages of the same kind as others, and only longer: axe takes seconds for them and has nothing to add
OF_A_KIND = {"algorithms", "backends", "complexity", "object-size"}
# pages that together have every colour
COLOURFUL = {"pages", "broken", "few", "single"}


def violations(page, **options):
    """What axe finds, each with the elements that it found it on."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    found = axe.run(page, options={"resultTypes": ["violations"], **options}).response["violations"]
    return [(entry["id"], [node["html"][:160] for node in entry["nodes"]][:4]) for entry in found]


@pytest.mark.slow
def test_every_page_is_whole_and_accessible_wide_and_narrow_light_and_dark(visit, report):
    paths = sorted(report.rglob("*.html"))
    kinds = {"index.html", "replay.html", "atlas.html", "truth.html", "trust.html", "points.html", "how-to.html"}
    assert kinds <= {path.name for path in paths}
    wrong = []
    for path in paths:
        seen, name = visit(path.as_uri()), str(path.relative_to(report))
        for size, scheme in ((DESKTOP, "light"), (PHONE, "light"), (PHONE, "dark"), (DESKTOP, "dark")):
            seen.page.set_viewport_size(size)
            seen.page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
            wrong += [(name, size["width"], scheme, out) for out in seen.page.evaluate(STICKING_OUT)]
            if path.parent.name in OF_A_KIND or size != (PHONE if scheme == "dark" else DESKTOP):
                continue
            if scheme == "dark":
                wrong += [(name, size["width"], scheme, found) for found in violations(seen.page)]
            elif path.parent.name in COLOURFUL:  # all that is not a matter of colour is the same in the light
                wrong += [(name, scheme, found) for found in violations(seen.page, runOnly=["color-contrast"])]
        wrong += [(name, error) for error in seen.errors]
        wrong += [(name, url) for url in seen.requests if not url.startswith(("file:", "data:"))]
        seen.page.context.close()
    assert not wrong, "\n".join(map(str, wrong))


@pytest.mark.slow
def test_the_replay_is_a_click_away_from_its_page_and_back(visit, report):
    seen = visit((report / "pages" / "single" / "index.html").as_uri())
    seen.page.get_by_role("link", name="Play this run").click()
    seen.page.wait_for_selector("html.drawn")
    seen.page.get_by_role("link", name="Back to the experiment").click()
    assert seen.page.get_by_role("heading", name="Look at the scene").is_visible()
    assert not seen.errors
