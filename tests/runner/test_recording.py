"""Which scene of an experiment a sweep records for its page."""

from harness.runner.recording import MOST_BODIES, MOST_HITS, MOST_LINES, MOST_SECONDS, worth_recording
from harness.store.records import RunRecord

SMALL = {"status": "ok", "count": 10, "events": 100, "run_seconds": 0.1}


def run(point, status, **metrics):
    return RunRecord("e", point, 0, status, None, 0, True, {}, metrics)


def chosen(*rows):
    given = [{"point": f"p{place}", **SMALL, **row} for place, row in enumerate(rows)]
    bodies = {row["point"]: row.pop("count") for row in given}
    return worth_recording(bodies, [run(**row) for row in given])


def test_the_fullest_scene_is_chosen_and_the_first_of_equals():
    assert chosen({"count": 5}, {"count": 50}, {"count": 50}, {"count": 20}) == "p1"


def test_what_is_too_full_too_long_or_failed_is_not():
    large = [
        {"count": MOST_BODIES + 1},
        {"events": MOST_HITS + 1},
        {"run_seconds": 2 * MOST_SECONDS},
        {"near_pairs": MOST_LINES + 1},
        {"events": float("nan")},
        {"status": "failed"},
    ]
    assert chosen(*large) is None
    assert chosen(*large, {"count": 1}) == f"p{len(large)}"


def test_an_experiment_whose_runs_report_nothing_has_no_replay():
    assert worth_recording({"p0": 3}, [run("p0", "failed"), run("p0", "ok")]) is None
