"""A sweep that was interrupted has broken nothing: its report says in a sentence what is missing."""

import re

import pytest

from harness.report.missing import missing_runs
from harness.report.site import render
from harness.store import tables
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow

EXPECT = [{"metric": "energy_drift", "at_most": 1e-12}, {"metric": "escaped", "equals": 0}]
CLAIMS = [{"metric": "pair_tests", "exponent_of": "count", "between": [1, 3]}]
METHOD = {"backend": "fcl", "algorithm": "grid", "shape": "hull"}
METRICS = {"run_seconds": (0.5, "s"), "pair_tests": (10.0, "1"), "energy_drift": (0.0, "1"), "escaped": (0.0, "1")}


def swept(path, names, runs, *, finished=False, repeats=5, lacking=None):
    """A results file of experiments with two points each, of which so many runs were made."""
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"processor": "Example"}, {})
        for name in names:
            points = [PointRow(f"{name}-{count}", {"count": count, **METHOD}) for count in (5, 10)]
            specification = {"expect": EXPECT, "claims": CLAIMS, "swept": ["count"], "measure": {"repeats": repeats}}
            if lacking is not None:
                specification["lacking"] = lacking
            database.list_experiment(sweep, name, name.capitalize(), None, "title: x\n", specification, points)
        every = [(name, count, repeat) for name in names for count in (5, 10) for repeat in range(repeats)]
        for name, count, repeat in every[:runs]:
            database.add_run(sweep, f"{name}-{count}", repeat, "ok", None, "", METRICS, True)
        if finished:
            database.finish_sweep(sweep)
    return path


def of(path):
    return missing_runs(tables.experiments(path), tables.runs(path))


@pytest.mark.parametrize(
    ("runs", "finished", "said"),
    [
        (12, False, "<strong>18 of 30 runs are missing</strong>; <code>harness sweep</code> does the rest."),
        (29, False, "<strong>1 of 30 runs is missing</strong>; <code>harness sweep</code> does the rest."),
        (0, False, "<strong>30 of 30 runs are missing</strong>; <code>harness sweep</code> does the rest."),
        (12, True, "<strong>18 of 30 runs are missing</strong>: they were not asked for, or their backend is not "
                   "installed; <code>harness sweep</code> does those that it can, and says what brings the backends of "
                   "the others."),
        (30, False, "<strong>The sweep did not come to its end</strong>, and has judged nothing of what it measured; "
                    "<code>harness sweep</code> does the rest."),
    ],
)  # fmt: skip
def test_what_is_missing_is_said_with_how_much_there_is_to_do(tmp_path, runs, finished, said):
    assert of(swept(tmp_path / "x.db", ["a", "b", "c"], runs, finished=finished)) == said


@pytest.mark.parametrize(
    ("lacking", "runs", "said"),
    [
        ({}, 6, ": 4 were not asked for; <code>harness sweep</code> does the rest."),
        ({"fcl": "it is not installed; pip install 'x[y]'"}, 9,
         ": 1 was passed over (it is not installed; pip install &#39;x[y]&#39;)."),
        ({"drake": "it is not installed"}, 9, ": 1 was not asked for; <code>harness sweep</code> does the rest."),
    ],
)  # fmt: skip
def test_of_what_was_passed_over_it_is_said_what_brings_it(tmp_path, lacking, runs, said):
    path = swept(tmp_path / "x.db", ["a"], runs, finished=True, lacking=lacking)
    assert of(path).endswith(said)


def test_a_run_that_experiments_share_is_missing_once(tmp_path):
    path = swept(tmp_path / "x.db", ["a"], 4)
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"processor": "Example"}, {})
        points = [PointRow("a-5", {"count": 5, **METHOD})]
        database.list_experiment(sweep, "b", "B", None, "", {"swept": [], "measure": {"repeats": 7}}, points)
    assert "8 of 12 runs are missing" in of(path)


@pytest.mark.slow
def test_the_pages_of_a_sweep_stopped_at_a_fifth_have_nothing_broken_and_say_what_is_missing(tmp_path):
    cases, others = (
        [f"{kind}-{number}" for number in range(count)] for kind, count in (("stability/case", 9), ("other", 11))
    )
    pages = dict(render(swept(tmp_path / "x.db", [*cases, *others], 35)))
    overview = pages["index.html"]
    assert overview.count("165 of 200 runs are missing") == 1
    assert overview.index("runs are missing") < overview.index("</h1>")
    for absent in ("Broken or failed", "not judged", "</strong> survives"):  # nothing failed, and no case was judged
        assert absent not in overview
    said = {}
    for name, page in pages.items():
        if re.fullmatch(r"pages/.+/index\.html", name):
            assert "Broken or failed" not in page
            said[name] = re.findall(r"(\d+) of 10 runs are missing", page)
    assert sorted(said.values()) == [[]] * 3 + [["10"]] * 16 + [["5"]]


def test_a_whole_sweep_says_nothing_of_the_kind_and_what_it_broke_is_red(tmp_path):
    path = swept(tmp_path / "x.db", ["a"], 10)
    with Database.open(path) as database:
        for kind, rows in (("expectation", EXPECT), ("claim", CLAIMS)):
            database.add_verdicts(1, 1, kind, [VerdictRow(row, "fails", f"{row['metric']} is wrong") for row in rows])
        database.finish_sweep(1)
    overview = dict(render(path))["index.html"]
    assert "missing" not in overview.split("</h1>")[0].split("<main")[1]
    assert "Broken or failed" in overview
    assert "energy drift is wrong" in overview
