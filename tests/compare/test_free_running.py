"""Two backends run the same scene by their own hits, up to the first that only one of them reports."""

from harness.compare.free_running import run_both
from tests.conftest import needs_pybullet, random_scene


@needs_pybullet
def test_flights_of_equal_backends_never_part_and_those_of_a_blind_one_do_at_its_first_miss(defective):
    scene = random_scene("sphere", 12, 4.0, seed=3)
    how = {"frames": 60, "dt": 1 / 30, "response": "elastic"}
    (same,) = run_both(scene, ("fcl", "pybullet"), **how).free_runs
    assert same.diverged is None
    assert same.shared_hits > 0
    assert same.afterwards[0].pair_hits_per_second == same.afterwards[1].pair_hits_per_second > 0
    (other,) = run_both(scene, ("fcl", defective("blind")), **how).free_runs
    assert 0 < other.diverged <= 2.0
    seeing, blind = other.afterwards
    assert seeing.pair_hits_per_second > 0 == blind.pair_hits_per_second
    assert abs(seeing.energy_change) < 1e-12


def test_a_flight_that_crashes_is_a_failure_at_its_frame(defective):
    scene = random_scene("sphere", 4, 3.0, seed=2)
    scene.bodies.positions[0] = [-1.0, 0.0, 0.0]
    found = run_both(scene, ("fcl", defective("crashes")), frames=3, dt=0.01, response="reflect")
    assert [(failure.backend, failure.query_index) for failure in found.failures] == [("crashes", 1)]
    assert "SIGSEGV" in found.failures[0].reason
