"""Which scene of an experiment a sweep records for its page."""

import pandas as pd

from harness.runner.recording import MOST_BODIES, MOST_HITS, MOST_SECONDS, worth_recording

SMALL = {"status": "ok", "count": 10, "events": 100, "run_seconds": 0.1}


def chosen(*rows):
    table = pd.DataFrame([{"point": f"p{place}", **SMALL, **row} for place, row in enumerate(rows)])
    return worth_recording(dict(zip(table["point"], table["count"], strict=True)), table.drop(columns="count"))


def test_the_fullest_scene_is_chosen_and_the_first_of_equals():
    assert chosen({"count": 5}, {"count": 50}, {"count": 50}, {"count": 20}) == "p1"


def test_what_is_too_full_too_long_or_failed_is_not():
    large = [
        {"count": MOST_BODIES + 1},
        {"events": MOST_HITS + 1},
        {"run_seconds": 2 * MOST_SECONDS},
        {"status": "failed"},
    ]
    assert chosen(*large) is None
    assert chosen(*large, {"count": 1}) == "p4"


def test_an_experiment_whose_runs_report_nothing_has_no_replay():
    assert worth_recording({"p0": 3}, pd.DataFrame({"point": ["p0"], "status": ["failed"]})) is None
