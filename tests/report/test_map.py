"""The map: each cell has the fastest method that is right there, and is in doubt where that cannot be told."""

import re
from io import BytesIO

import pytest
from PIL import Image

from harness.report.drawing import palette
from harness.report.map.answers import answers
from harness.report.map.cells import maps_of
from harness.report.results import Results
from harness.report.site import render
from harness.report.styles import letter, style_of
from harness.vocabulary import ALGORITHMS, MethodName
from tests.report.conftest import Invented, write

AXES = {"x": "count", "y": "run_seconds", "map": {"x": "count", "y": "packing"}}
# seconds by method, number of bodies and packing
SECONDS = {
    ("grid", 10): 1.0, ("grid", 100): 2.0, ("brute-force", 10): 1.5, ("brute-force", 100): 40.0,
}  # fmt: skip


def fate(parameters, repeat, metrics):
    """Brute force is as fast as the grid in the dilute scene of 10 bodies, and wrong in the dense one of 100."""
    seconds = SECONDS[parameters["algorithm"], parameters["count"]]
    if parameters["count"] == 10 and parameters["packing"] < 0.1:
        seconds = 1.0
    noise = metrics["box_seconds"] / (metrics["frames"] * 2e-6 * parameters["count"])
    metrics["run_seconds"] = seconds * noise
    if parameters["algorithm"] == "grid" and parameters["count"] == 100 and parameters["packing"] > 0.1:
        metrics["missed_hits"] = 0.5


def invented(repeats=5, **more):
    scenes = [
        {"count": count, "box": [count + packing] * 3, "packing": packing}
        for count in (10, 100)
        for packing in (0.05, 0.2)
    ]
    swept = {"zip": scenes, "algorithm": ["brute-force", "grid"], **more}
    return Invented("map", "Map", swept, {"shape": "sphere"}, repeats, report=AXES, fate=fate)


@pytest.fixture
def maps(tmp_path):
    def made(**given):
        return maps_of(Results(write(tmp_path / "results.db", [invented(**given)])).pages)

    return made


def test_a_field_is_won_by_the_fastest_that_is_right_there_and_is_in_doubt_where_two_are_as_fast(maps):
    [made] = maps()
    said = {(answer.cell.x, answer.cell.y): (answer.method, bool(answer.cell.doubt)) for answer in answers(made)}
    assert said[10, 0.2] == ("own grid", False)
    assert said[100, 0.05] == ("own grid", False)
    assert said[100, 0.2] == ("fcl brute-force", False)  # the other is fast, and wrong
    assert said[10, 0.05][1]


def test_with_too_few_repeats_every_field_with_a_rival_is_in_doubt_and_says_why(maps):
    [made] = maps(repeats=2)
    rivals = [answer for answer in answers(made) if len(answer.cell.ranked) > 1]
    assert len(rivals) == 3
    assert all("too few repeats to rank" in answer.sure for answer in rivals)


def test_an_accuracy_is_reached_by_the_longest_step_that_suffices(maps):
    coarse, fine = maps(dt=[1 / 60, 1 / 1000])
    assert (coarse.accuracy, fine.accuracy) == (1 / 60, 1 / 1000)
    for made in (coarse, fine):
        for cell in made.cells:
            assert {entry.point.parameters["dt"] for entry in cell.ranked} == {made.accuracy}
    assert "motion: {dt: 0.001}" in answers(fine)[0].yaml


def test_the_overview_shows_the_map_first_with_every_field_in_a_table(tmp_path):
    pages = dict(render(write(tmp_path / "results.db", [invented()])))
    page = pages["index.html"]
    assert page.index('id="map"') < page.index('id="findings"')
    assert len(re.findall(r"<tr data-x=", page)) == 4
    assert page.count("<title>10 bodies, packing 0.2: own grid") == 2  # wide and narrow
    assert "map.svg" in pages
    assert pages == dict(render(tmp_path / "results.db"))


def test_every_algorithm_has_a_colour_and_a_letter_of_its_own():
    methods = [MethodName("fcl", name, "hull") for name in ALGORITHMS if name != "native"]
    assert len({style_of(method) for method in methods}) == len(methods)
    assert len({letter(method) for method in methods}) == len(methods)


@pytest.mark.slow
def test_figures_can_be_had_as_pdf_and_png_with_the_same_bytes_every_time(tmp_path):
    path = write(tmp_path / "results.db", [invented()])
    files, again = (dict(render(path, ("pdf", "png"))) for _ in range(2))
    assert files == again
    for name in [name for name in files if name.endswith(".svg")]:
        assert files[name.replace(".svg", ".pdf")].startswith(b"%PDF")
        assert files[name.replace(".svg", ".png")].startswith(b"\x89PNG")
    assert {name for name in files if name.endswith(".svg")} >= {"map.svg", "pages/map/run_seconds.svg"}
    assert {name: text for name, text in files.items() if isinstance(text, str)} == dict(render(path))


@pytest.mark.slow
def test_a_figure_in_another_format_has_the_light_colours(tmp_path):
    image = dict(render(write(tmp_path / "results.db", [invented()]), ("png",)))["map.png"]
    colours = {pixel for _, pixel in Image.open(BytesIO(image)).convert("RGB").getcolors(2**24)}
    assert tuple(bytes.fromhex(palette.LIGHT[1][1:])) in colours  # of the grid, around its cells
    assert (255, 255, 255) in colours
