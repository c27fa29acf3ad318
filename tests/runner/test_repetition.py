"""A short run is flown until its clocks mean something, and counts what one flight counts."""

from harness.measure.metrics import METRICS
from harness.motion.hits import Outcome
from harness.runner.execute import execute
from harness.runner.repetition import LONG_ENOUGH, fly_long_enough


def flights(*seconds):
    """A scene whose flights take these CPU times, one after another, and count how often they were flown."""
    left = list(seconds)

    def fly():
        took = left.pop(0)
        counted = {"frames": 60, "pair_hits": len(seconds) - len(left)}
        return Outcome(counted | {"run_seconds": took, "frames_per_second": 60 / took}, None)

    return fly


def test_a_long_run_is_flown_once():
    outcome, number = fly_long_enough(flights(2 * LONG_ENOUGH))
    assert (number, outcome.metrics["run_seconds"]) == (1, 2 * LONG_ENOUGH)


def test_clocks_are_means_over_all_flights_and_counters_those_of_the_first():
    outcome, number = fly_long_enough(flights(0.5 * LONG_ENOUGH, 0.25 * LONG_ENOUGH, 0.75 * LONG_ENOUGH))
    assert number == 3
    assert outcome.metrics["run_seconds"] == 0.5 * LONG_ENOUGH
    assert outcome.metrics["frames_per_second"] == 60 / (0.5 * LONG_ENOUGH)  # the rate of the mean, no mean of rates
    assert (outcome.metrics["frames"], outcome.metrics["pair_hits"]) == (60, 1)


def test_flying_without_end_for_a_clock_that_stands_still_is_given_up():
    outcome, number = fly_long_enough(lambda: Outcome({"frames": 0, "run_seconds": 0.0}, None))
    assert outcome.metrics["run_seconds"] == 0.0
    assert number > 1


def test_every_flight_of_a_real_scene_counts_the_same(spheres, monkeypatch):
    """Whatever a backend keeps from one flight to the next, what is reported is what a single flight reports."""
    for algorithm in ("brute-force", "grid", "tree"):
        point = spheres(count=12, algorithm=algorithm).points[0]
        often = execute(point, None)
        monkeypatch.setattr("harness.runner.repetition.LONG_ENOUGH", 0.0)
        once = execute(point, None)
        monkeypatch.undo()
        assert often.flights > once.flights == 1
        exact = [name for name in once.metrics if not METRICS[name].noisy]
        assert {name: often.metrics[name] for name in exact} == {name: once.metrics[name] for name in exact}
