"""The experiments on stability, in a short form: all that they expect holds, and no run ends without a verdict."""

from functools import cache
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.measure.verdicts import verdict_on
from harness.runner.execute import execute
from harness.runner.key import point_key
from harness.runner.preparation import prepare
from harness.runner.scene_of_point import derived_parameters
from harness.runner.servers import files_of, on_demand_of
from harness.scene.launch import PlacementError
from harness.store.records import RunRecord
from harness.store.tables import run_table

CASES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "experiments" / "stability").glob("*.yaml"))}
# What takes long is flown for less time, in a smaller crowd, or at fewer points.
SHORTER = {
    "at-rest": {"duration": 1},
    "billion-seconds": {"count": 3},
    "dense-packing": {"algorithm": ["grid", "predictive", "predictive"], "backend": "fcl", "duration": 0.02},
    "energy-momentum": {"duration": 2, "count": 20},
    "fast-spin": {"duration": 0.5},
    "inelastic-collapse": {"duration": 4},
    "long-step": {"duration": 20},
    "no-room": {"duration": 0.01},
    "query-fast-spin": {"duration": 0.2},
    "rattling": {"dt": 0.1},
    "size-ratio": {"duration": 1, "count": 100},
    "sizes": {"duration": 0.2, "shape": ["sphere", "hull"]},
    "symmetries-of-shapes": {"duration": 0.25, "shape": "mesh"},
}


@cache
def flown(name):
    """The experiment, and its runs as the database would have them; each is flown in this process."""
    (experiment,), meshes = prepare([CASES[name]], SHORTER.get(name, {}))
    records = []
    for point in experiment.points:
        files = files_of(experiment, point, meshes)
        status, reason, metrics = "ok", None, {}
        try:
            metrics = execute(point, files, on_demand=on_demand_of(experiment)).metrics
        except (PlacementError, InputError) as error:
            status, reason = "rejected", str(error)
        parameters = {**point.parameters, **derived_parameters(point, files)}
        records.append(RunRecord(name, point_key(point, files), 0, status, reason, 0, True, parameters, metrics))
    return experiment, run_table(records)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CASES if not name.startswith("hundred-")])
def test_all_that_a_case_expects_holds(name):
    experiment, runs = flown(name)
    asked = {"grid"} if name.startswith("query-") else {"grid", "predictive"}  # which tells hits alone
    assert set(runs["algorithm"]) >= asked
    for row in experiment.expect:
        verdict = verdict_on(row, runs, experiment.swept, "expectation")
        assert verdict.verdict == "holds", verdict.statement


@pytest.mark.slow
def test_stepped_runs_fall_short_where_they_are_known_to():
    """A case whose claims hold for every method would not be stiff."""
    for name in ("far-away", "grazing-between-frames", "rattling", "tight-box"):
        experiment, runs = flown(name)
        for row in experiment.claims:
            groups = verdict_on(row, runs, experiment.swept, "claim").groups
            held = {group.parameters["algorithm"] for group in groups if group.verdict == "holds"}
            assert held == {"predictive"}, name
