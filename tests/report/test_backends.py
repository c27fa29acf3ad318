"""The page of backends: who is wrong is proven, shown, struck through and not ranked."""

import re

import pytest

from harness.report.backends.proof import sentences_of
from harness.report.site import render
from harness.store.database import Database
from harness.store.records import PointRow
from harness.vocabulary import algorithms_of

PROOF = {"kind": "common point", "point": [0.5, 0.0, -0.25], "first": [[0, "1"]], "second": [[2, "1/2"], [3, "1/2"]]}
CASE = {
    "backends": ["fcl", "odd"], "wrong": "odd", "bodies": [3, 7], "gap": -0.01, "file": None, "minimised_to": 2,
    "depends_on_order": False, "certificate": PROOF | {"pose": "frame 12", "call": 13, "touching": True},
}  # fmt: skip
SHOWN = CASE | {
    "shape": "hull", "sizes": [1.0, 1.0], "mesh": "cube.ply", "text": "title: odd is wrong\n",
    "section": [[[0, 0, 1, 0], [1, 0, 0, 1], [0, 1, 0, 0]], [[0.5, 0, 1.5, 0], [1.5, 0, 0.5, 1], [0.5, 1, 0.5, 0]]],
    "minimised": {"bodies": [0, 1], "gap": -0.125, "certificate": PROOF | {"touching": True}},
}  # fmt: skip
COUNTS = {"shape": "hull", "poses": 10, "containment": 0, "approximation": 0}


def document(backends, real):
    pair = COUNTS | {"backends": backends, "verdicts": 1000, "agree": 990 - real, "undecided": 10, "real": real}
    crash = {"kind": "crashed", "pose": "frame 4", "call": 5, "reason": "ended by signal 11 (SIGSEGV)"}
    failed = {"backends": backends, "wrong": "odd", "bodies": [], "gap": None, "certificate": crash, "file": None}
    flight = {
        "backends": backends, "shape": "hull", "bodies": 50, "response": "elastic", "duration": 10.0, "diverged": 2.5,
        "shared_hits": 147,
        "afterwards": [
            {"backend": name, "pair_hits_per_second": 33.0, "box_hits_per_second": 20.0, "energy_change": 1e-16}
            for name in backends
        ],
    }  # fmt: skip
    replaced = {
        "backends": backends, "shape": "mesh", "backend": backends[1], "verdicts": 90, "touching": 30, "reported": 40,
        "false_hits": 10, "contained": 2, "misses": 3, "false_share": 0.25, "missed_share": 0.1,
    }  # fmt: skip
    gaps = {"undecided": {"-3": 10}} | ({"real": {"-15": real}} if real else {})
    return {
        "pairs": [pair], "cases": [CASE, failed] if real else [], "shared": [], "unsupported": [],
        "checked": [{"backends": backends, "shape": "hull", "verdicts": 50, "contradicted": 0}],
        "approximations": [replaced], "flights": [flight],
        "gaps": [{"backends": backends, "shape": "hull", "counts": gaps}],
        "shown": [SHOWN] if real else [], "title": "Peers", "versions": {},
    }  # fmt: skip


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    path = tmp_path_factory.mktemp("compared") / "results.db"
    leaves = {"shape": "hull", "count": 50, "packing": 0.1}
    seconds = {"fcl": 2e-3, "pybullet": 3e-3, "odd": 1e-3}
    points = [PointRow(name, leaves | {"backend": name, "algorithm": algorithms_of(name)[0]}) for name in seconds]
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"processor": "one"}, {})
        database.list_experiment(sweep, "peers", "Peers", None, "title: Peers\n", {"swept": ["backend"]}, points)
        for name, value in seconds.items():
            for repeat in range(5):
                taken = {"pair_seconds_per_frame": value * (1 + 0.001 * repeat)}
                database.add_run(sweep, name, repeat, "ok", None, None, {k: (v, "s") for k, v in taken.items()}, True)
                database.add_control(sweep, name, repeat, "ok", {k: v * 1.001**repeat for k, v in taken.items()})
        database.add_comparison("harness compare peers.yaml", "peers", ("fcl", "odd"), "a", document(["fcl", "odd"], 4))
        sound = document(["fcl", "pybullet"], 0)
        database.add_comparison("harness compare peers.yaml", "peers", ("fcl", "pybullet"), "b", sound)
    return path


@pytest.fixture(scope="module")
def pages(compared):
    return dict(render(compared))


def test_the_same_results_give_the_same_bytes(compared, pages):
    assert dict(render(compared)) == pages


def test_the_page_is_in_the_navigation_and_refers_to_nothing_outside(pages):
    assert '<a href="backends.html">Backends</a>' in pages["index.html"]
    assert not re.search(r'(?:src|href)="(?:https?:)?//', pages["backends.html"])
    for file in re.findall(r'href="([^"#]+)" download', pages["backends.html"]):
        assert file in pages


def test_a_wrong_backend_is_struck_through_and_the_fastest_right_one_is_best(pages):
    page = pages["backends.html"]
    speed = page[page.index('id="speed"') : page.index('id="reading"')]
    rows = {row.split("<")[0]: row for row in re.findall(r'<tr><th scope="row">(.*?)</tr>', speed, re.DOTALL)}
    assert "struck" in rows["odd, native"]
    assert "best" not in rows["odd, native"]
    assert "wrong 2" in rows["odd, native"]
    assert "best" in rows["fcl, brute-force"]
    assert "never wrong in" in rows["pybullet, native"]


def test_a_case_has_its_proof_picture_and_file(pages):
    page = pages["backends.html"]
    assert "Bodies 0 and 1 overlap by 0.125 m; odd says that they do not touch." in page
    assert "the point (0.5, 0, −0.25) m lies in both" in page
    assert "1 vertex of body 0 and 2 vertices of body 1" in page
    assert "Seen at frame 12 (question 13 of its scene)" in page
    assert pages["cases/case-1.yaml"] == "title: odd is wrong\n"
    assert pages["cases/case-1.svg"].startswith("<svg")
    assert "harness view cases/case-1.yaml" in page


def test_a_case_of_another_query_says_what_was_asked_and_told():
    proof = {"kind": "nearest points and separating planes", "first": [[0, "1"]], "second": [[2, "1"]], "planes": 3}
    asked = {"query": "distance", "within": 0.5, "tolerance": 1e-6, "told": 0.25, "error": "too wide"}
    gap = {"gap": 0.125, "certificate": proof | {"lower": 0.125, "upper": 0.125, "touching": False}}
    found = sentences_of(CASE | asked | {"minimised": {"bodies": [0, 1]} | gap | asked})
    assert found[0] == "Bodies 0 and 1 are 0.125 m apart; odd says that they are 0.25 m apart."
    assert found[1] == "Asked: distance within 0.500 m. The answer is too wide a gap."
    assert "3 planes keep all parts of one body at least 0.125 m from all parts of the other" in found[2]
    late = {"query": "impact", "tolerance": 1e-6, "moment": 0.0625, "told": None, "error": "missed"}
    found = sentences_of(CASE | late | {"minimised": SHOWN["minimised"] | late})
    assert found[0].endswith("0.0625 s after the start of the frame; odd says that they do not begin to touch in it.")
    assert found[-1] == "2 bodies in one frame show it by themselves."


def test_crashes_approximations_flights_and_gaps_are_told(pages):
    page = pages["backends.html"]
    assert "peers: odd at frame 4 (question 5): ended by signal 11 (SIGSEGV)" in page
    assert "25 %" in page
    assert "<h2>Bodies in flight</h2>" in page
    assert 'id="figure-gaps"' in page
    assert "4 real" in page
