"""What a trace tells of the queries other than collision: every gap with its points, and every time of impact."""

import csv
import io
import json

import pytest

from harness.cli.main import main

TWO = """
title: Two
scene: {{shape: sphere, box: [9, 9, 9], bodies: [{{position: [0, 0, 0]}},
  {{position: [2, 0, 0], velocity: [-1, 0, 0]}}]}}
motion: {{duration: 2, dt: 1/4, response: none}}
engine: {{algorithm: grid, {engine}}}
"""


@pytest.fixture
def traced(tmp_path, capsys):
    def ask(engine, *arguments):
        path = tmp_path / "two.yaml"
        path.write_text(TWO.format(engine=engine))
        assert main(["trace", str(path), *arguments]) == 0
        return capsys.readouterr().out

    return ask


def passing(time):
    """The states of the two at a time: body 1 flies on, as nothing is answered."""
    velocities = [[0, 0, 0], [-1, 0, 0]]
    return {
        "positions": [[0, 0, 0], [2 - time, 0, 0]],
        "velocities_before": velocities,
        "velocities_after": velocities,
        "impulses": [[0, 0, 0], [0, 0, 0]],
    }


def test_every_gap_is_told_frame_by_frame(traced):
    """Spheres of diameter 1 whose centres are 2 - t apart: within 0.5 from t = 1/2 on, touching from t = 1 on."""
    found = json.loads(traced("query: distance, within: 0.5", "--json"))
    assert found["query"] == "distance"
    assert [row["frame"] for row in found["near"]] == list(range(2, 9))
    assert [row["gap"] for row in found["near"]] == [max(0.0, 1 - row["time"]) for row in found["near"]]
    assert found["near"][0]["points"] == [[0.5, 0, 0], [1.0, 0, 0]]
    assert all(row["bodies"] == [0, 1] for row in found["near"])
    (event,) = found["events"]
    assert event == {"time": 0.5, "kind": "near", "bodies": [0, 1], "gap": 0.5} | passing(0.5)
    assert set(found) == {"events", "final", "counters", "query", "near"}


def test_a_query_without_gaps_has_points_but_no_gap(traced):
    found = json.loads(traced("query: tolerance, within: 0.5", "--json"))
    assert {row["gap"] for row in found["near"]} == {None}
    assert [row["frame"] for row in found["near"]] == list(range(2, 9))
    assert found["events"] == [{"time": 0.5, "kind": "near", "bodies": [0, 1]} | passing(0.5)]


def test_impacts_are_told_at_their_times(traced):
    found = json.loads(traced("query: impact", "--json"))
    assert found["query"] == "impact"
    assert found["impacts"] == [{"time": 1.0, "bodies": [0, 1]}]
    assert found["events"] == [{"time": 1.0, "kind": "pair", "bodies": [0, 1]} | passing(1.0)]
    assert "query" not in json.loads(traced("query: collision", "--json"))


def test_tables_and_text_name_the_gap(traced):
    (row,) = csv.DictReader(io.StringIO(traced("query: distance, within: 0.5", "--csv")))
    assert (row["time"], row["kind"], row["gap"]) == ("0.5", "near", "0.5")
    assert "gap" not in traced("query: impact", "--csv").splitlines()[0]
    assert (row["position_x"], row["other_position_x"], row["other_velocity_after_x"]) == ("0.0", "1.5", "-1.0")
    assert "0.5 s  bodies 0 and 1 are near, 0.5 m apart\n" in traced("query: distance, within: 0.5")
    assert "7 answers in 7 frames: a pair that is near at a frame, the least gap 0 m\n" in traced(
        "query: distance, within: 0.5"
    )
    assert "1 s  bodies 0 and 1 begin to touch\n" in traced("query: impact")


def test_an_impact_between_frames_has_the_state_at_its_own_time_and_walls_follow(traced):
    """Frames of 0.4 s: they touch at 1 s, the third frame ends at 1.2 s; a wall is met at 6 s by what flies on."""
    found = json.loads(traced("query: impact", "--json", "--set", "dt=0.4", "--set", "duration=6.4"))
    met, wall = found["events"]
    assert met["time"] == pytest.approx(1.0)
    assert met["positions"][1] == pytest.approx([1.0, 0, 0])
    assert wall["wall"] == "x-"
    assert wall["bodies"] == [1]
    assert wall["velocities_before"] == [[-1, 0, 0]]
    assert wall["velocities_after"] == [[1, 0, 0]]
    mass = wall["impulses"][0][0] / 2
    assert mass > 0
    assert wall["impulses"] == [[2 * mass, 0, 0]]
