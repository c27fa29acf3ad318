"""Two sweeps held against each other, by the command and on the page, from results made up for it."""

import json
from datetime import datetime, timezone

import pytest

from harness.cli.main import main
from harness.report.site import render
from harness.report.sweeps.difference import DRIFT, difference
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow

LEAVES = {"backend": "fcl", "algorithm": "grid", "shape": "sphere"}

NOISE = (1.0, 1.01, 0.99, 1.02, 0.98)
CLAIM = {"metric": "run_seconds", "at_most": 3}


@pytest.fixture
def results(tmp_path):
    """Adds a sweep of points {count: factor of the time}; with `key`, as another version of the program."""
    path = tmp_path / "results.db"

    def sweep(factors, *, key="v1", tests=1.0, statuses=None, verdict="holds", grade=True, machine="m", finished=True,
              control=1.01, repeats=5):  # fmt: skip
        with Database.open(path) as database:
            number = database.begin_sweep("harness sweep", None, "0.1.0", {"fingerprint": machine}, {})
            points = [
                PointRow(f"{key}-{count}", LEAVES | {"count": count, "packing": count / 1e3}) for count in factors
            ]
            specification = {"swept": ["count"], "claims": [CLAIM]}
            listed = database.list_experiment(number, "<b>", "T", None, "", specification, points)
            for repeat, noise in enumerate(NOISE[:repeats]):
                for count, factor in factors.items():
                    status = (statuses or {}).get(count, "ok")
                    seconds = factor * count * noise
                    metrics = {"run_seconds": (seconds, "s"), "pair_tests": (tests * count**2, "1")}
                    database.add_run(
                        number, f"{key}-{count}", repeat, status, None, None, metrics if status == "ok" else {}, grade,
                        started=datetime.now(timezone.utc),
                    )  # fmt: skip
                    database.add_control(number, f"{key}-{count}", repeat, "ok", {"run_seconds": seconds * control})
            database.add_verdicts(number, listed, "claim", [VerdictRow(CLAIM, verdict, "<i>so</i>")])
            if finished:
                database.finish_sweep(number)
        return path

    return sweep


def told(path, *words, code=0, capsys):
    capsys.readouterr()
    assert main(["diff", "--db", str(path), "--json", *words]) == code
    return json.loads(capsys.readouterr().out)


def paces(document):
    return {point["parameters"]["count"]: point["pace"] for point in document["points"]}


def test_a_point_is_slower_or_faster_only_beyond_the_drift_between_sweeps(results, capsys):
    results({2: 1.0, 4: 1.0, 8: 1.0, 16: 1.0})
    path = results({2: 1.0, 4: 1.3, 8: 0.7, 16: 1.0 + DRIFT / 2})
    document = told(path, capsys=capsys)
    assert paces(document) == {2: "same", 4: "slower", 8: "faster", 16: "same"}
    slower = next(point for point in document["points"] if point["pace"] == "slower")
    assert slower["ratio"]["low"] <= 1.3 <= slower["ratio"]["high"]
    assert slower["ratio"]["coverage"] == pytest.approx(0.9375)
    assert document["counts"] == {
        "slower": 1, "faster": 1, "same": 2, "unknown": 0, "changed": 0, "untouched": 0, "verdicts": 0,
    }  # fmt: skip
    assert told(path, "--fail-on", "changed", capsys=capsys)
    told(path, "--fail-on", "slower", code=1, capsys=capsys)
    told(path, "--fail-on", "changed", "--fail-on", "slower", code=1, capsys=capsys)


def test_a_noisy_machine_raises_the_floor(results, capsys):
    results({2: 1.0}, control=1.5)
    document = told(results({2: 1.3}, control=1.5), capsys=capsys)
    assert document["floor"] == pytest.approx(0.5)
    assert paces(document) == {2: "same"}


def test_another_count_status_or_verdict_is_a_change(results, capsys):
    path = results({2: 1.0})
    results({2: 1.0}, tests=2.0)
    document = told(path, "--fail-on", "changed", code=1, capsys=capsys)
    assert document["points"][0]["counters"] == {"pair_tests": [4.0, 8.0]}
    results({2: 1.0}, tests=2.0, statuses={2: "crashed"})
    document = told(path, "--fail-on", "changed", code=1, capsys=capsys)
    assert document["points"][0]["statuses"] == ["ok", "crashed"]
    results({2: 1.0}, tests=2.0, verdict="fails")
    document = told(path, "1", "4", capsys=capsys)
    assert document["verdicts"] == [
        {"experiment": "<b>", "before": "holds", "after": "fails", "statement": "<i>so</i>"}
    ]


def test_what_another_version_measured_is_compared_by_its_parameters(results, capsys):
    results({2: 1.0, 4: 1.0}, key="v1")
    document = told(results({2: 2.0, 8: 1.0}, key="v2"), capsys=capsys)
    assert paces(document) == {2: "slower"}


def test_without_numbers_the_sweep_before_that_came_to_its_end_is_taken(results, capsys):
    results({2: 1.0})
    results({2: 5.0}, finished=False)
    path = results({2: 1.0})
    assert told(path, capsys=capsys)["before"]["sweep"] == 1
    assert told(path, "2", capsys=capsys)["before"]["sweep"] == 2
    assert paces(told(path, "2", "3", capsys=capsys)) == {2: "faster"}


@pytest.mark.parametrize("how", [{"grade": False}, {"machine": "other"}])
def test_times_that_do_not_compare_tell_nothing(results, capsys, how):
    results({2: 1.0})
    assert paces(told(results({2: 3.0}, **how), "--fail-on", "slower", capsys=capsys)) == {2: "unknown"}


def test_what_was_not_measured_again_is_counted_not_compared(results, capsys):
    results({2: 1.0, 4: 1.0})
    path = results({2: 1.0})
    assert told(path, capsys=capsys)["counts"]["untouched"] == 1


@pytest.mark.parametrize(("words", "said"), [(["7"], "there is no sweep 7; there are 1"), ([], "measured the same")])
def test_what_cannot_be_compared_is_a_sentence(results, capsys, words, said):
    path = results({2: 1.0})
    assert main(["diff", "--db", str(path), *words]) == 2
    assert said in capsys.readouterr().err


def test_the_command_says_what_differs_to_a_person(results, capsys):
    results({2: 1.0, 4: 1.0})
    assert main(["diff", "--db", str(results({2: 1.0, 4: 2.0}))]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("before  sweep 1,")
    assert lines[2] == "<b> (count 4): slower, 4 s to 8 s, 2 times [2, 2]"
    assert lines[3].startswith("2 points measured by both: 1 slower, 0 faster, 1 not to be told apart")


def test_the_report_has_a_page_of_it_once_there_is_something_to_compare(results):
    path = results({2: 1.0, 4: 1.0})
    assert "sweeps.html" not in dict(render(path))
    pages = dict(render(results({2: 1.0, 4: 2.0}, tests=2.0, verdict="fails")))
    page = pages["sweeps.html"]
    assert 'href="sweeps.html"' in pages["index.html"]
    assert "slower" in page
    assert "pair_tests 16 → 32" in page
    assert "&lt;b&gt;" in page
    assert "<b>" not in page
    assert "<i>so" not in page
    assert difference(path).changed


EIGHT = dict.fromkeys(range(1, 9), 1.0)


def test_a_drift_of_the_whole_machine_slows_no_point(results, capsys):
    results(EIGHT)
    document = told(results(dict.fromkeys(EIGHT, 1.3)), "--fail-on", "slower", capsys=capsys)
    assert set(paces(document).values()) == {"same"}
    assert document["drift"] == pytest.approx(1.3)
    assert document["points"][0]["ratio"]["median"] == pytest.approx(1.0)


def test_a_point_that_is_slower_than_the_drift_is_called_slower(results, capsys):
    results(EIGHT)
    document = told(results({count: 1.8 if count == 3 else 1.3 for count in EIGHT}), capsys=capsys)
    assert [count for count, pace in paces(document).items() if pace == "slower"] == [3]
    assert document["counts"]["slower"] == 1


def test_no_machine_drifts_by_more_than_a_factor_of_two(results, capsys):
    results(EIGHT)
    document = told(results(dict.fromkeys(EIGHT, 3.0)), "--fail-on", "slower", code=1, capsys=capsys)
    assert document["counts"]["slower"] == 8
    assert document["drift"] == 2.0


def test_below_five_points_a_quarter_is_allowed_for_what_drifts(results, capsys):
    results({2: 1.0, 4: 1.0})
    document = told(results({2: 1.2, 4: 1.2}), "--fail-on", "slower", capsys=capsys)
    assert (document["drift"], document["floor"]) == (None, 0.25)


@pytest.mark.parametrize("repeats", [1, *(pytest.param(repeats, marks=pytest.mark.slow) for repeats in (2, 3)), 4])
def test_fewer_than_five_pairs_call_no_point_slower_and_their_span_is_a_range(results, capsys, repeats):
    results(EIGHT, repeats=repeats)
    path = results({count: 1.0 + count for count in EIGHT}, repeats=repeats)
    document = told(path, "--fail-on", "slower", capsys=capsys)
    assert set(paces(document).values()) == {"unknown"}
    assert {point["ratio"]["coverage"] for point in document["points"]} == {None}
    page = dict(render(path))["sweeps.html"]
    assert page.count("(range)") == (8 if repeats > 1 else 0)
