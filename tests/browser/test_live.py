"""The live page in a real browser: a person changes the scene, and sees hits and costs."""

import json
import os
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pytest

from tests.browser.conftest import CUBES
from tests.browser.test_pages import violations

pytestmark = pytest.mark.xdist_group("browser")


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Of a server that Ctrl-C is to end in the end."""
    path = tmp_path_factory.mktemp("live") / "cubes.yaml"
    path.write_text(CUBES)
    command = [sys.executable, "-m", "harness", "view", "--live", str(path)]
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, [os.getcwd(), os.environ.get("PYTHONPATH")]))
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    try:
        yield server.stdout.readline().split()[0]
        server.send_signal(signal.SIGINT)
        assert server.wait(timeout=30) == 0
        assert server.stderr.read() == ""
    finally:
        server.kill()
        server.wait()


@pytest.mark.slow
def test_settings_are_run_at_once_shown_and_listed_with_their_costs(visit, address):
    seen = visit(address)
    page = seen.page
    page.wait_for_selector("#costs tbody tr")
    page.wait_for_function("() => /of \\d+ hits/.test(document.getElementById('now').textContent)")
    page.fill("[name=count]", "3")
    page.select_option("[name=algorithm]", "grid")
    page.wait_for_function("() => document.querySelectorAll('#costs tbody tr').length > 1")
    page.wait_for_function("() => !document.getElementById('settings').hasAttribute('aria-busy')")
    cells = page.locator("#costs tbody tr").first.locator("th, td").all_text_contents()
    assert cells[:4] == ["grid", "fcl", "mesh", "3"]
    hits = int(cells[6]) + int(cells[7])
    assert f"of {hits} hits" in page.text_content("#now")
    assert float(cells[9]) > 0
    assert not violations(page)
    assert not seen.errors
    assert all(url.startswith((address, "data:")) for url in seen.requests)


@pytest.mark.slow
def test_what_cannot_be_run_is_said_in_a_sentence_and_the_scene_stays(visit, address):
    page = visit(address).page
    page.wait_for_selector("#costs tbody tr")
    page.wait_for_function("() => !document.getElementById('settings').hasAttribute('aria-busy')")
    page.wait_for_function("() => document.getElementById('now').textContent")
    before = page.text_content("#now")
    page.fill("[name=count]", "many")
    page.keyboard.press("Enter")
    page.wait_for_selector("#outcome.wrong")
    page.wait_for_function("() => !document.getElementById('settings').hasAttribute('aria-busy')")
    assert page.text_content("#outcome") == 'count=many: must be a whole number, not "many".'
    assert page.text_content("#now") == before


@pytest.mark.slow
def test_a_page_elsewhere_cannot_ask_through_a_name_of_its_own(address):
    request = urllib.request.Request(f"{address}run?count=3", headers={"Host": "elsewhere.example"})
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(request)
    with urllib.request.urlopen(f"{address}run?count=-1") as answer:
        assert "count=-1" in json.load(answer)["error"]
