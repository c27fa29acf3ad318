"""Titles, questions and values that would do something to a page: nothing of them runs, and every page stays whole."""

import json

import pytest

from harness.report.site import write_report
from tests.browser.conftest import DESKTOP, PHONE
from tests.browser.test_pages import STICKING_OUT
from tests.report.conftest import Invented, write

pytestmark = pytest.mark.xdist_group("browser")

RUNS = "document.documentElement.dataset.ran = 1"
TITLES = {
    "script": f"<script>{RUNS}</script>",
    "end": f"</script></title></svg>--><img src=x onerror='{RUNS}'>",
    "quotes": f"\"' onmouseover='{RUNS}' `${{{RUNS}}}`",
    "right-to-left": "\u202egnp.exe \u2067\u200f\u0627\u0644\u0639\u0631\u0628\u064a\u0629",
    "long": "x" * 3000,
    "lines": "one\ntwo\r\nthree\u2028four\u2029five\t\u0085six",
    "template": "{{ 7 * 7 }} {% raw %} ${7 * 7} &lt;b&gt; &amp; &#60;",
    "letters": "\u0000\u0007\u001b[31m \U0001f600 \ufffe \u0301\u0301\u0301\u0301",
}

# what must be seen of those that HTML does not hold letter by letter
SHOWN = {"lines": "three", "letters": "[31m"}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hostile")
    experiments = [
        Invented(
            name, title, {"backend": ["fcl", title], "count": [5, 10, 20]}, {"mesh": title, "algorithm": "grid"},
            repeats=2, question=title,
            published={"source": title, "note": title, "rows": [{"count": 5, "frames_per_second": 80.0}]},
            fate=lambda point, *_, said=title: ("failed", said) if point["backend"] != "fcl" else None,
            warnings=lambda _, said=title: [said],
        )
        for name, title in TITLES.items()
    ]  # fmt: skip
    return write_report(write(folder / "results.db", experiments), folder / "pages").parent


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TITLES, ""])
def test_no_text_runs_or_breaks_a_page(visit, pages, name):
    wrong = []
    paths = [pages / "index.html"] if not name else sorted((pages / "pages" / name).rglob("*.html"))
    assert paths
    for path in paths:
        seen = visit(path.as_uri())
        for size in (DESKTOP, PHONE):
            seen.page.set_viewport_size(size)
            wrong += [(path.name, size["width"], out) for out in seen.page.evaluate(STICKING_OUT)]
        wrong += [(path.name, error) for error in seen.errors]
        wrong += [(path.name, url) for url in seen.requests if not url.startswith(("file:", "data:"))]
        if seen.page.evaluate("document.documentElement.dataset.ran"):
            wrong.append((path.name, "a script of a title ran"))
        if name and not seen.page.evaluate(
            f"document.body.textContent.includes({json.dumps(SHOWN.get(name, TITLES[name][:8]))})"
        ):
            wrong.append((path.name, "the title is not shown"))
        seen.page.context.close()
    assert not wrong, "\n".join(map(str, wrong))
