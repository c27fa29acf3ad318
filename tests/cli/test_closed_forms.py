"""Exact answers of event-driven motion, through the real command `harness trace --json`."""

import json
from math import sqrt

import numpy as np
import pytest
import yaml

from harness.cli.main import main
from harness.motion.law import MotionLaw
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import make_bodies
from tests.methods.flights import fly

HUGE = [1e6, 1e6, 1e6]


@pytest.fixture
def trace(tmp_path, capsys):
    """Traces given spheres of diameter 1: rows of position, velocity and what else a body has."""

    def run(bodies, duration, box=(100.0, 100.0, 100.0), **motion):
        experiment = {
            "title": "Closed form",
            "scene": {"shape": "sphere", "box": list(box), "bodies": bodies},
            "motion": {"duration": duration, "response": "elastic", **motion},
            "engine": {"algorithm": "predictive"},
        }
        file = tmp_path / "case.yaml"
        file.write_text(yaml.safe_dump(experiment))
        assert main(["trace", str(file), "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    return run


def body(x, vx, y=0.0, **more):
    return {"position": [x, y, 0.0], "velocity": [vx, 0.0, 0.0], **more}


def pairs(document):
    """Events of pairs, without the states of their bodies."""
    names = ("time", "kind", "bodies")
    return [{name: event[name] for name in names} for event in document["events"] if event["kind"] == "pair"]


def speeds(document):
    return [velocity[0] for velocity in document["final"]["velocity"]]


@pytest.mark.slow
def test_head_on_four_apart_meets_at_one_and_a_half_and_swaps(trace):
    document = trace([body(-2, 1), body(2, -1)], 3.0)
    assert pairs(document) == [{"time": 1.5, "kind": "pair", "bodies": [0, 1]}]
    assert speeds(document) == [-1.0, 1.0]
    assert document["final"]["time"] == 3.0
    (hit,) = document["events"]
    assert hit["positions"] == [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]
    assert hit["velocities_before"] == [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]
    assert hit["velocities_after"] == [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    assert hit["impulses"] == [[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]


@pytest.mark.parametrize("offset", [0.3, 1 - 1e-9, 1 - 1e-12, 1 + 1e-12, 1 + 1e-9])
@pytest.mark.slow
def test_an_oblique_pass_hits_where_the_formula_says_if_it_is_inside_the_sum_of_radii(trace, offset):
    found = pairs(trace([body(0, 0), body(-5, 2, offset)], 10.0, box=HUGE))
    if offset > 1:
        assert found == []
    else:
        miss = (1 - offset) * (1 + offset)
        assert found[0]["time"] == pytest.approx((5 - sqrt(miss)) / 2, rel=1e-12)


@pytest.mark.parametrize("ratio", [1e6, 1e12])
def test_unequal_masses_share_velocities_as_their_masses_say(trace, ratio):
    after = speeds(trace([body(-2, 1, mass=ratio), body(2, 0, mass=1.0)], 4.0, box=HUGE))
    assert after == pytest.approx([(ratio - 1) / (ratio + 1), 2 * ratio / (ratio + 1)], rel=4e-16)


@pytest.mark.parametrize(("count", "gap"), [(5, 0.0), (20, 1e-12), (50, 0.0)])
def test_a_cradle_hands_the_velocity_to_its_last_ball(trace, count, gap):
    row = [body(k * (1 + gap), 0) for k in range(count)]
    document = trace([*row, body(-3, 1)], 2.0 + count, box=HUGE, restitution=1.0)
    assert len(pairs(document)) == count
    assert speeds(document) == pytest.approx([0.0] * (count - 1) + [1.0, 0.0], abs=1e-12)


def test_two_into_a_cradle_of_five_send_two_out_after_ten_hits(trace):
    row = [body(float(k), 0) for k in range(5)]
    document = trace([*row, body(-3, 1), body(-4, 1)], 8.0, box=HUGE)
    assert len(pairs(document)) == 10
    assert speeds(document) == pytest.approx([0, 0, 0, 1, 1, 0, 0], abs=1e-12)


def test_a_corner_sends_a_ball_back_the_way_it_came(trace):
    bodies = [{"position": [0, 0, 0], "velocity": [1, 1, 1]}]
    document = trace(bodies, 9.0, box=(10, 10, 10))
    assert sorted(event["wall"] for event in document["events"]) == ["x+", "y+", "z+"]
    assert {event["time"] for event in document["events"]} == {4.5}
    assert document["final"]["position"][0] == pytest.approx([0, 0, 0], abs=8e-15)


# Galperin's billiard: the wall is x-; by the end the heavy ball has come back, and not reached the wall behind it.
DIGITS_OF_PI = {0: 3, 1: 31, 2: 314, 3: 3141, 4: 31415, 5: 314159}


@pytest.mark.parametrize("digits", [0, 1, 2])
def test_galperins_billiard_counts_the_digits_of_pi(trace, digits):
    light, heavy = body(-9.0, 0, mass=1.0), body(-5.0, -1, mass=100.0**digits)
    document = trace([light, heavy], 16.0, box=(20.0, 4.0, 4.0))
    assert len(document["events"]) == DIGITS_OF_PI[digits]
    assert all(event.get("wall", "x-") == "x-" for event in document["events"])


def test_galperins_billiard_goes_on_to_count_them_where_the_command_would_print_for_a_minute():
    for digits, hits in DIGITS_OF_PI.items():
        bodies = make_bodies([[-9, 0, 0], [-5, 0, 0]], [[0, 0, 0], [-1, 0, 0]], masses=[1.0, 100.0**digits])
        scene = Scene("sphere", (), bodies, Box(np.array([10.0, 2.0, 2.0])))
        found = fly(scene, "predictive", MotionLaw(16.0, 1 / 60, "elastic")).trace
        assert len(found.times) == hits
        assert set(found.walls.tolist()) == {-1, 0}  # between the two, and at x-


def test_an_implosion_on_a_resting_ball_leaves_it_at_rest(trace):
    around = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            position, velocity = [0.0] * 3, [0.0] * 3
            position[axis], velocity[axis] = 3 * side, -side
            around.append({"position": position, "velocity": velocity})
    document = trace([*around, {"position": [0, 0, 0]}], 4.0)
    assert len(pairs(document)) == 9
    assert document["final"]["velocity"][6] == pytest.approx([0, 0, 0], abs=1e-15)
    for ball, velocity in zip(around, document["final"]["velocity"], strict=False):
        assert velocity == pytest.approx([-component for component in ball["velocity"]], abs=1e-15)


def test_a_ball_at_a_million_diameters_a_second_does_not_fly_through_its_target(trace):
    document = trace([body(0, 0), body(-50, 1e6)], 1e-4, box=HUGE)
    assert pairs(document)[0]["time"] == pytest.approx(49e-6, rel=1e-12)
    assert speeds(document) == pytest.approx([1e6, 0], abs=1e-9)


def test_nothing_is_missed_from_a_hundred_million_diameters_away(trace):
    far = 1e8
    for offset in (0.0, 0.5, 0.999):
        found = pairs(trace([body(0, 0), body(-far, far / 10, offset)], 20.0, box=[4e8] * 3))
        assert found[0]["time"] == pytest.approx(10 - sqrt(1 - offset**2) * 10 / far, rel=1e-15)


def test_a_folding_ball_is_on_the_triangle_wave_after_18_000_seconds(trace):
    document = trace([body(0, 1)], 18_000.0, box=(10, 10, 10))
    phase = (18_000.0 + 4.5) % 18
    expected = phase - 4.5 if phase <= 9 else 13.5 - phase
    assert document["final"]["position"][0][0] == pytest.approx(expected, abs=1e-10)
    assert len(document["events"]) == 2000
