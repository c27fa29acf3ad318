"""Metrics made on demand, results that are no numbers, and refusals that are expected: through the real commands."""

import json

import pytest

from harness.cli.main import main

PLAIN = """
title: Plain
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.5}
measure: {repeats: 1, timeout: 20}
"""
ASKING = (
    PLAIN
    + """
expect:
  - {metric: mirror_error, at_most: 0}
  - {metric: quaternion_drift, at_most: 1.0e-14}
"""
)
REFUSED = """
title: Refused
scene: {shape: sphere, count: 23, box: [2.5, 2.5, 2.5]}
sweep: {count: [2, 23]}
motion: {duration: 0.1}
measure: {repeats: 1, timeout: 20}
expect:
  - {metric: rejected, where: {count: 23}, equals: 1}
  - {metric: escaped, where: {count: 2}, equals: 0}
"""


def runs(capsys):
    capsys.readouterr()
    assert main(["export", "--format", "json"]) == 0
    return json.loads(capsys.readouterr().out)["runs"]


@pytest.mark.slow
def test_a_metric_is_made_where_an_experiment_names_it_also_of_points_that_were_run_without(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plain.yaml").write_text(PLAIN)
    assert main(["sweep", "plain.yaml", "--quiet"]) == 0
    (run,) = runs(capsys)
    assert "mirror_error" not in run["metrics"]

    (tmp_path / "asking.yaml").write_text(ASKING)
    assert main(["sweep", "plain.yaml", "asking.yaml", "--quiet"]) == 0
    for run in runs(capsys):  # the point is shared by both experiments
        assert run["metrics"]["mirror_error"] == 0
        assert run["metrics"]["quaternion_drift"] <= 1e-14
        assert "reversal_error" not in run["metrics"]
    main(["sweep", "plain.yaml", "asking.yaml", "--dry-run"])
    assert "0 runs to do" in capsys.readouterr().out

    (tmp_path / "refused.yaml").write_text(REFUSED)
    assert main(["sweep", "refused.yaml"]) == 0
    assert "1 ok, 1 rejected" in capsys.readouterr().out
    refused = next(run for run in runs(capsys) if run["status"] == "rejected")
    assert "at most 0.740" in refused["reason"]


@pytest.mark.slow
def test_a_refusal_that_is_not_expected_fails_the_sweep(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "refused.yaml").write_text(REFUSED.replace("where: {count: 23}", "where: {count: 2}"))
    assert main(["sweep", "refused.yaml", "--quiet"]) == 1
    assert "rejected is 0 for count=2 (expected exactly 1)" in capsys.readouterr().out


@pytest.mark.slow
def test_frames_are_held_beside_a_copy_of_the_memory_that_they_cannot_do_without(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = PLAIN.replace("count: 4", "count: 40").replace("box: [5, 5, 5]", "box: [9, 9, 9]")
    (tmp_path / "plain.yaml").write_text(text + "sweep: {algorithm: [grid, predictive]}\n")
    (tmp_path / "asking.yaml").write_text(
        text + "sweep: {algorithm: [grid, predictive]}\nreport: {x: algorithm, y: [times_of_memory]}\n"
    )
    assert main(["sweep", "plain.yaml"]) == 0
    assert all(run["metrics"].get("copy_bandwidth") is None for run in runs(capsys))
    assert main(["sweep", "asking.yaml", "--fresh"]) == 0
    of = {run["parameters"]["algorithm"]: run["metrics"] for run in runs(capsys) if run["experiment"] == "asking"}
    found = of["grid"]
    frame = found["run_seconds"] / found["frames"]
    assert found["frame_bytes_per_body"] == 72
    assert found["times_of_memory"] == pytest.approx(frame / (72 * 40 / found["copy_bandwidth"]))
    assert of["predictive"].get("times_of_memory") is None
