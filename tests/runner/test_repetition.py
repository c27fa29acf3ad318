"""A short run is flown until its clocks mean something, and counts what one flight counts."""

import pytest

from harness.measure.metrics import METRICS
from harness.motion.hits import Outcome
from harness.motion.law import MotionLaw
from harness.runner.execute import execute
from harness.runner.point import law_of, method_of_point
from harness.runner.repetition import COLD_UNTIL, LONG_ENOUGH, fly_long_enough, warm
from harness.runner.scene_of_point import build_scene
from harness.scene.scene_files import SceneFiles

SHARES = [2.0**-k for k in range(6, -1, -1)]


def flights(*seconds, frames=60):
    """A scene whose flights take these CPU times, one after another, and count how often they were flown."""
    left = list(seconds)

    def fly():
        took = left.pop(0)
        counted = {"frames": frames, "pair_hits": len(seconds) - len(left)}
        return Outcome(counted | {"run_seconds": took, "frames_per_second": 60 / took}, None)

    return fly, fly


def test_a_long_run_is_flown_once():
    outcome, number = fly_long_enough(*flights(COLD_UNTIL))
    assert (number, outcome.metrics["run_seconds"]) == (1, COLD_UNTIL)


def test_a_long_run_of_short_frames_is_timed_while_nobody_observes_them():
    seen, unseen = [Outcome({"frames": 2000, "run_seconds": seconds}, None) for seconds in (1.9, 1.1)]
    outcome, number = fly_long_enough(lambda: seen, lambda: unseen)
    assert (number, outcome.metrics["run_seconds"]) == (2, 1.1)
    assert fly_long_enough(*flights(2.1, frames=2000))[1] == 1


def test_the_cold_flight_of_a_run_that_is_long_enough_is_not_timed():
    outcome, number = fly_long_enough(*flights(2.2 * LONG_ENOUGH, LONG_ENOUGH))
    assert (number, outcome.metrics["run_seconds"]) == (2, LONG_ENOUGH)


def test_clocks_are_means_over_all_flights_but_the_first_and_counters_are_those_of_the_first():
    outcome, number = fly_long_enough(*flights(5 * LONG_ENOUGH, 0.25 * LONG_ENOUGH, 0.75 * LONG_ENOUGH))
    assert number == 3
    assert outcome.metrics["run_seconds"] == 0.5 * LONG_ENOUGH
    assert outcome.metrics["frames_per_second"] == 60 / (0.5 * LONG_ENOUGH)  # the rate of the mean, no mean of rates
    assert (outcome.metrics["frames"], outcome.metrics["pair_hits"]) == (60, 1)


def test_flying_without_end_for_a_clock_that_stands_still_is_given_up():
    def standing() -> Outcome:
        return Outcome({"frames": 0, "run_seconds": 0.0}, None)

    outcome, number = fly_long_enough(standing, standing)
    assert outcome.metrics["run_seconds"] == 0.0
    assert number > 1


@pytest.mark.parametrize(
    ("takes", "shares"), [(1.0, [1 / 64]), (0.004, [1 / 64, 1 / 32, 1 / 16]), (0.0, [*SHARES, *[1.0] * 9])]
)
def test_a_scene_is_warmed_by_ever_more_of_it_as_long_as_a_sample_takes(takes, shares, monkeypatch):
    flown = []
    monkeypatch.setattr("harness.runner.repetition.process_time", lambda: takes * len(flown))
    law = MotionLaw(64.0, 0.5, "reflect")
    assert warm(flown.append, law) == len(shares)
    assert [flight.duration / law.duration for flight in flown] == shares
    assert {(flight.dt, flight.response) for flight in flown} == {(0.5, "reflect")}


def test_what_warms_is_a_frame_at_least():
    assert MotionLaw(0.1, 1 / 60, "none").beginning(1e-3).frames == 1
    assert MotionLaw(0.001, 1 / 60, "none").beginning(0.5).duration == 0.001


@pytest.mark.parametrize("algorithm", ["brute-force", "grid", "tree", "sap", "predictive"])
def test_every_method_is_warmed_the_same_way_on_what_is_not_timed(spheres, monkeypatch, algorithm):
    """Each loads twice: what is flown to warm up, for the beginning of the scene, and what is measured, whole."""
    point = spheres(count=12, algorithm=algorithm).points[0]
    method = method_of_point(point)
    loaded, flown = [], []

    class Loading:
        plan, warm_ups = method.plan, method.warm_ups

        def load(self, scene, plan):
            pipeline = method.load(scene, plan)
            loaded.append(pipeline)
            return Flying(pipeline)

    class Flying:
        def __init__(self, pipeline):
            self.pipeline = pipeline

        def fly(self, law, traced=False, observed=True):
            flown.append((len(loaded), law.duration, observed))
            return self.pipeline.fly(law, traced=traced, observed=observed)

    monkeypatch.setattr("harness.runner.execute.method_of_point", lambda _: Loading())
    execute(point, SceneFiles())
    whole = point.motion.duration
    assert flown[0] == (1, max(whole / 64, point.motion.dt), False)
    assert {duration for number, duration, _ in flown if number == 2} == {whole}
    observed = [(number, seen) for number, _, seen in flown]
    assert observed.count((2, True)) == 1
    assert observed[observed.index((2, True)) + 1 :] == [(2, False)] * observed.count((2, False))


@pytest.mark.parametrize(
    ("algorithm", "engine"),
    [
        ("brute-force", {}),
        ("grid", {}),
        ("predictive", {}),
        ("grid", {"query": "distance", "within": 0.1}),
        ("grid", {"query": "impact"}),
    ],
)
def test_a_flight_that_nobody_observes_reports_every_clock_and_nothing_else(spheres, algorithm, engine):
    point = spheres(count=4, algorithm=algorithm, response="none", **engine).points[0]
    scene = build_scene(point, SceneFiles())
    law, method = law_of(point, scene), method_of_point(point)
    pipeline = method.load(scene, method.plan(scene, law))
    assert set(pipeline.fly(law, observed=False).metrics) == {
        name for name in pipeline.fly(law).metrics if METRICS[name].clock
    }


def test_every_flight_of_a_real_scene_counts_the_same(spheres, monkeypatch):
    """Whatever a backend keeps from one flight to the next, what is reported is what a single flight reports."""
    for algorithm in ("brute-force", "grid", "tree"):
        point = spheres(count=12, algorithm=algorithm).points[0]
        often = execute(point, SceneFiles())
        monkeypatch.setattr("harness.runner.repetition.COLD_UNTIL", 0.0)
        monkeypatch.setattr("harness.runner.repetition.LONG_FRAME", 0.0)
        once = execute(point, SceneFiles())
        monkeypatch.undo()
        assert often.flights > once.flights == 1
        exact = [name for name in once.metrics if not METRICS[name].noisy]
        assert {name: often.metrics[name] for name in exact} == {name: once.metrics[name] for name in exact}
