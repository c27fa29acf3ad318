"""A method is as right as it was found to be itself: nothing is said of one that no comparison has asked."""

import re

from harness.report.backends.correctness import correctness, newest
from harness.report.site import render
from harness.store.database import Database
from harness.store.records import ComparisonRecord, PointRow
from harness.vocabulary import MethodName

SPEEDS = {("fcl", "brute-force"): 4e-3, ("fcl", "grid"): 1e-3, ("fcl", "tree"): 2e-3, ("pybullet", "native"): 3e-3}
SPEED = "pair_seconds_per_frame"
LEAVES = {"shape": "hull", "count": 50, "packing": 0.1}


def document(backends, wrong=()):
    pair = {"backends": list(backends), "shape": "hull", "poses": 10, "verdicts": 4186, "agree": 4186 - len(wrong)}
    pair |= {"undecided": 0, "containment": 0, "approximation": 0, "real": len(wrong)}
    proof = {"kind": "common point", "point": [0, 0, 0], "first": [], "second": [], "pose": "frame 1", "call": 2}
    cases = [{"backends": list(backends), "wrong": name, "certificate": proof} for name in wrong]
    empty = {name: [] for name in ("shared", "unsupported", "checked", "approximations", "flights", "gaps", "shown")}
    return {"pairs": [pair], "cases": cases, **empty}


def pages(path, *documents):
    """The report, where an experiment timed four methods and these comparisons were made."""
    points = [
        PointRow(f"{backend}/{algorithm}", LEAVES | {"backend": backend, "algorithm": algorithm})
        for backend, algorithm in SPEEDS
    ]
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"processor": "one"}, {})
        database.list_experiment(
            sweep, "peers", "Peers", None, "", {"swept": ["backend", "algorithm"], "report": {"y": [SPEED]}}, points
        )
        for point, seconds in zip(points, SPEEDS.values(), strict=True):
            for repeat in range(5):
                taken = seconds * (1 + 0.001 * (repeat - 2))
                database.add_run(sweep, point.key, repeat, "ok", None, None, {SPEED: (taken, "s")}, True)
                database.add_control(sweep, point.key, repeat, "ok", {SPEED: taken * 1.001**repeat})
        for made in documents:
            database.add_comparison("harness compare", "peers", tuple(made["pairs"][0]["backends"]), "key", made)
    return dict(render(path))


def speed_rows(path, *documents):
    """The rows of the table of speeds on the page of backends."""
    page = pages(path, *documents)["backends.html"]
    table = page[page.index('id="speed"') : page.index('id="reading"')]
    return {row.split("<")[0]: row for row in re.findall(r'<tr><th scope="row">(.*?)</tr>', table, re.DOTALL)}


def test_a_backend_alone_was_asked_about_every_pair_and_says_nothing_of_its_grid(tmp_path):
    rows = speed_rows(tmp_path / "x.db", document(["fcl", "pybullet"]))
    assert "never wrong in 4\u202f186\u00a0verdicts" in rows["fcl, brute-force"]
    assert "never wrong in 4\u202f186\u00a0verdicts" in rows["pybullet, native"]
    assert "not compared" in rows["fcl, grid"]
    assert "not compared" in rows["fcl, tree"]
    assert [name for name, row in rows.items() if "best" in row] == ["pybullet, native"]


def test_a_grid_that_is_wrong_is_struck_through_and_takes_no_other_method_with_it(tmp_path):
    wrong = document(["fcl/grid", "pybullet"], wrong=["fcl/grid"] * 3)
    rows = speed_rows(tmp_path / "x.db", wrong, document(["fcl/tree", "pybullet"]))
    assert "struck" in rows["fcl, grid"]
    assert "wrong 3\u00a0times" in rows["fcl, grid"]
    assert "never wrong in 4\u202f186\u00a0verdicts" in rows["fcl, tree"]
    assert "never wrong in 8\u202f372\u00a0verdicts" in rows["pybullet, native"]
    assert "not compared" in rows["fcl, brute-force"]
    assert [name for name, row in rows.items() if "best" in row] == ["fcl, tree"]


def test_a_method_that_is_wrong_has_no_rank_on_the_page_of_its_experiment_either(tmp_path):
    found = pages(tmp_path / "x.db", document(["fcl/grid", "pybullet"], wrong=["fcl/grid"]))
    page = found["pages/peers/index.html"]
    findings, warnings = page.split('<div class="box warning">')[:2]
    assert "<strong>fcl tree</strong> has the lowest" in findings
    assert "<strong>fcl/grid was proven wrong</strong> at poses of this experiment" in warnings
    assert re.search(r'grid</th>.*<s class="struck">1</s>', page)
    assert "Struck through: was proven wrong by comparison, and is not ranked." in page


def test_an_error_that_two_methods_share_counts_for_both():
    record = ComparisonRecord("x", ("fcl/grid", "odd"), "a", "", document(["fcl/grid", "odd"]))
    case = {"wrong": "fcl/grid and odd", "certificate": {"kind": "common point"}}
    found = correctness([ComparisonRecord(**(vars(record) | {"document": {**record.document, "shared": [case]}}))])
    assert found.wrong == {MethodName("fcl", "grid", "hull"): 1, MethodName("odd", "native", "hull"): 1}


def test_of_two_spellings_of_the_same_comparison_the_newest_counts():
    old = ComparisonRecord("x", ("fcl", "pybullet"), "2026-01-01", "", document(["fcl", "pybullet"]))
    new = ComparisonRecord("x", ("fcl/brute-force", "pybullet"), "2026-02-01", "", document(["fcl", "pybullet"]))
    elsewhere = ComparisonRecord("y", ("fcl", "pybullet"), "2026-01-01", "", document(["fcl", "pybullet"]))
    assert newest([old, new, elsewhere]) == [new, elsewhere]


def dispute_pages(report_of, digests, **fields):
    def flown(parameters, repeat, metrics):
        metrics["pair_seconds"] *= 4 if parameters["algorithm"] == "tree" else 1
        metrics |= {"event_digest": float(digests[parameters["algorithm"]]), "pair_contacts": 3.0}

    swept = {"algorithm": ["brute-force", "grid", "tree"]}
    base = {"shape": "hull", "response": fields.pop("response", "none"), "count": 10}
    return report_of(swept=swept, base=base, fate=flown, **fields)["pages/x/index.html"]


def test_methods_that_saw_different_hits_of_one_motion_are_not_ranked(report_of):
    page = dispute_pages(report_of, {"brute-force": 1, "grid": 2, "tree": 1})
    assert "fcl brute-force and own grid and fcl tree saw different hits of the same motion" in page
    assert "ahead of" not in page.split('<div class="box warning">')[0]


def test_methods_that_saw_the_same_or_flew_motions_of_their_own_are_ranked(report_of):
    same = dispute_pages(report_of, {"brute-force": 1, "grid": 1, "tree": 1})
    assert "saw different hits" not in same
    assert "ahead of" in same
    assert "saw different" not in dispute_pages(report_of, {"brute-force": 1, "grid": 2, "tree": 1}, response="reflect")


def test_a_page_says_where_bodies_had_to_wait_that_such_a_motion_is_ill_posed(report_of):
    for waits in (0.0, 321.0):

        def flown(parameters, repeat, metrics, waits=waits):
            metrics["stalled_events"] = waits

        base = {"shape": "hull", "count": 10}
        page = report_of(swept={"algorithm": ["grid", "predictive"]}, base=base, fate=flown)["pages/x/index.html"]
        assert ("up to 321 times: too many events came in one burst" in page) == (waits > 0)
        assert ("such a motion is ill-posed" in page) == (waits > 0)


def test_where_there_is_a_reference_it_says_who_is_right(report_of):
    page = dispute_pages(report_of, {"brute-force": 1, "grid": 2, "tree": 1}, reference={"algorithm": "predictive"})
    assert "saw different hits" not in page


def test_a_method_that_counts_otherwise_in_a_run_of_the_same_motion_is_named(report_of):
    def fate(parameters, repeat, metrics):
        if parameters["algorithm"] == "tree" and parameters["count"] == 40:
            metrics["pair_hits"] = 35.0 if repeat else 327.0

    swept = {"count": [10, 40], "zip": [{"backend": "fcl", "algorithm": name} for name in ("grid", "tree")]}
    page = report_of(swept=swept, fate=fate)["pages/x/index.html"]
    said = "<strong>fcl tree is not the same twice</strong> in 1 point: in runs of one and the same motion"
    assert said in page.replace("\u00a0", " ")
    assert "from 35 to 327" in page.replace("\u00a0", " ")
    assert "not the same twice" not in report_of(swept=swept)["pages/x/index.html"]
