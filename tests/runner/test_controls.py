"""Which runs are done twice: of points that do not fail, or there would be nothing to compare."""

from collections import Counter
from datetime import datetime, timezone

from harness.runner.executor import FinishedJob
from harness.runner.sweep import sweep
from harness.runner.task import Report
from harness.store.database import Database

METHODS = """
title: Spheres
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.5}
sweep: {algorithm: [grid, tree, brute-force]}
measure: {repeats: 6}
"""


class Failing:
    """Does nothing; runs of one algorithm fail. Counts what is asked of it."""

    def __init__(self, algorithm):
        self.algorithm, self.asked = algorithm, Counter()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def run(self, jobs, meshes, before):
        for job in jobs:
            algorithm = job.point.engine.algorithm
            self.asked[algorithm, job.control] += not job.recorded
            fails = algorithm == self.algorithm
            report = Report("failed", "as told") if fails else Report("ok", None, {"run_seconds": 1.0})
            yield FinishedJob(job, report, timing_grade=True, started=datetime.now(timezone.utc))


class Nothing:
    def begin(self, jobs, estimate):
        pass

    def before(self, job):
        pass

    def after(self, job, report):
        pass


def test_a_point_that_fails_is_replaced_as_a_control(spheres, tmp_path):
    experiment = spheres(METHODS)
    executor = Failing("tree")
    with Database.open(tmp_path / "results.db") as database:
        for _ in range(2):  # and the next sweep has nothing left to do
            sweep([experiment], {}, database, command="", progress=Nothing(), executor=executor)
    runs = {algorithm: executor.asked[algorithm, False] for algorithm in ("grid", "tree", "brute-force")}
    assert runs == dict.fromkeys(runs, 6)
    good = executor.asked["grid", True] + executor.asked["brute-force", True]
    assert good == 6
