"""One browser for all tests here, and pages that it is sent to: Debian's Chromium, driven by Playwright."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from harness.experiment.load import load_text
from harness.report.site import write_report
from harness.runner.execute import execute
from harness.runner.servers import files_of
from harness.scene.mesh_child import open_all
from harness.store.database import Database
from harness.store.recording import Recording
from tests.report.conftest import ALL, write
from tests.report.test_atlas_page import cell

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
# a WebGL2 that needs no graphics card, and no traffic of the browser's own
SWITCHES = (
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox", "--no-first-run", "--disable-quic"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
DESKTOP, PHONE = {"width": 1280, "height": 860}, {"width": 390, "height": 844}
CUBES = """
title: Cubes
scene: {mesh: cube.ply, shape: mesh, count: 8, box: [4, 4, 4], seed: 7}
motion: {duration: 4, dt: 1/50}
"""
SPHERES = """
title: Spheres
scene: {shape: sphere, count: 12, box: [5, 4, 4], size: {uniform: [0.5, 1.5]}}
motion: {duration: 3, response: elastic}
engine: {algorithm: predictive}
"""
GAPS = """
title: Gaps
scene: {mesh: cube.ply, shape: hull, count: 6, box: [3, 3, 3], seed: 3}
motion: {duration: 1, dt: 1/20, response: none}
engine: {algorithm: grid, query: distance, within: 0.5}
"""
IMPACTS = GAPS.replace("Gaps", "Impacts").replace("query: distance, within: 0.5", "query: impact")


def record(text: str) -> Recording:
    """The recording of an experiment's first point, flown in this process."""
    experiment = load_text(text, Path("browser.yaml"))
    point = experiment.points[0]
    files = files_of(experiment, point, open_all(experiment.mesh_paths.values()))
    recording = execute(point, files, recorded=True).recording
    assert recording is not None
    return recording


@pytest.fixture(scope="session")
def cubes() -> Recording:
    return record(CUBES)


@pytest.fixture(scope="session")
def spheres() -> Recording:
    return record(SPHERES)


@pytest.fixture(scope="session")
def gaps() -> Recording:
    return record(GAPS)


@pytest.fixture(scope="session")
def impacts() -> Recording:
    return record(IMPACTS)


@pytest.fixture(scope="session")
def report(cubes: Recording, spheres: Recording, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a report with every kind of page, two of them with a replay."""
    folder = tmp_path_factory.mktemp("report")
    write(folder / "results.db", ALL)
    with Database.open(folder / "results.db") as database:
        database.add_recording("homework/number-of-objects-0", cubes)
        database.add_recording("single-0", spheres)
        add_judged(database)
    return write_report(folder / "results.db", folder / "pages").parent


def add_judged(database: Database) -> None:
    """What engines answered to an atlas, and to a set of proven times, for their two pages."""
    none = {name: [] for name in ("pairs", "cases", "shared", "unsupported", "shown")}
    left_out = ["collision, hull of cube.ply, far; units: not asked, 30 s were spent"]
    for place, engine in enumerate(("fcl", "mujoco", "rapier3d")):
        cells = [
            cell(family, mesh, query, wrong=9 * place, beyond=place, deepest=0.1 * place) | {"engine": engine}
            for query in ("collision", "distance")
            for mesh in ("cube.ply", "needle.off")
            for family in ("random", "aligned", "grazing")
        ]
        document = none | {"left_out": left_out, "atlas": cells, "title": "Atlas", "versions": {}}
        database.add_comparison("harness compare", "atlas/short", (engine, "exact arithmetic"), engine, document)
        kinds = {"right": 40 - 3 * place, "missed": place, "late": 2 * place, "early": 0, "false": 0, "failed": 0}
        times = {"without_shape": 0, "latest": 1e-3 * place, "earliest": 0.0, "seconds_a_query": 1e-4}
        counted = {"asked": 40, **kinds, **times}
        told = {"backend": engine, "dt": None if place else 1 / 60, "problem": None, "failures": {}, "set": "truth"}
        told |= {"within": 1e-9, "every": 1, "commit": None, "versions": {}}
        told |= {"families": {"random": counted, "grazing": counted, "all": counted}}
        database.add_comparison(
            "harness truth ask", "set/truth", (engine, "proven times"), f"t{place}", {"truth": told}
        )


@pytest.fixture(scope="session")
def browser():
    """Chromium; the tests are skipped where there is none."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[dev]'")
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=list(SWITCHES), timeout=120_000)
        yield browser
        browser.close()


@dataclass
class Visit:
    """A page, and what went wrong on it or was asked of the network."""

    page: object
    errors: list[str]
    requests: list[str]


@pytest.fixture
def visit(browser):
    """Opens addresses, each in a browser as good as new; `script` runs before the page's own."""
    contexts = []

    def open_page(address: str, script: str = "", **options: object) -> Visit:
        context = browser.new_context(**({"viewport": DESKTOP, "reduced_motion": "reduce"} | options))
        contexts.append(context)
        if script:
            context.add_init_script(script)
        page = context.new_page()
        page.set_default_timeout(120_000)  # a busy machine takes its time to start a run
        found = Visit(page, [], [])
        page.on("console", lambda said: found.errors.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: found.errors.append(str(error)))
        page.on("request", lambda request: found.requests.append(request.url))
        page.goto(address)
        return found

    yield open_page
    for context in contexts:
        context.close()
