"""The scheduler against the plain event loop, on random small scenes."""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from harness.motion.predictive.codes import Event
from harness.motion.predictive.simulation import Simulation
from tests.motion.slow_reference import Reference

EVENTS = 40


@st.composite
def scenes(draw):
    """Mixed sizes, thin and tight and wide boxes, overlaps, spheres at rest."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    n = draw(st.integers(0, 9))
    spread = draw(st.sampled_from([1.0, 2.5, 5.0, 12.0]))
    radii = 0.5 * spread ** rng.uniform(-1, 0, n) if spread > 1 else np.full(n, 0.5)
    half = np.array([draw(st.sampled_from([0.55, 1.0, 1.5, 3.0, 40.0])) for _ in range(3)])
    positions = rng.uniform(-1, 1, (n, 3)) * np.maximum(half - radii[:, None], 0.0)
    velocities = rng.normal(size=(n, 3)) * draw(st.sampled_from([1.0, 1e-3, 1e6]))
    velocities[rng.random(n) < 0.2] = 0.0
    response = draw(st.sampled_from(["reflect", "elastic", "none"]))
    restitution = draw(st.sampled_from([1.0, 0.7])) if response == "elastic" else 1.0
    return {
        "positions": positions,
        "velocities": velocities,
        "radii": radii,
        "masses": radii**3 if draw(st.booleans()) else np.ones(n),
        "half_box": half,
        "response": response,
        "restitution": restitution,
    }


def until_too_close_to_call(reference, tolerance):
    """The events up to the first two of which rounding decides which is first."""
    times = np.array([event[0] for event in reference.events])
    close = np.flatnonzero(np.diff(times) <= tolerance)
    return reference.events[: close[0]] if len(close) else reference.events


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(scenes(), st.sampled_from(["cells", "lists"]))
def test_the_scheduler_meets_the_events_of_the_plain_loop(scene, search):
    ratio = scene["radii"].max(initial=1.0) / scene["radii"].min(initial=1.0) if len(scene["radii"]) else 1.0
    if scene["response"] == "none" or ratio >= 3.0:
        search = "cells"
    reference = Reference(
        **{name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in scene.items()}
    )
    while len(reference.events) < EVENTS and reference.step():
        pass
    simulation = Simulation(**scene, record=True, search=search)
    simulation.advance(np.inf, max_events=len(reference.events))
    scale = reference.time / max(len(reference.events), 1) + 1e-300
    expected = until_too_close_to_call(reference, 1e-9 * scale)
    found = simulation.events[: len(expected)]
    assume(simulation.counters["stalled_events"] == 0)
    assert [(int(e["kind"]), int(e["i"]), int(e["wall"] if e["kind"] == Event.WALL else e["j"])) for e in found] == [
        event[1:] for event in expected
    ]
    # chaos multiplies rounding by some ten a hit
    assert np.allclose(found["time"], [event[0] for event in expected], rtol=1e-6, atol=1e-7 * scale)


def test_a_scene_without_events_has_none():
    for response in ("reflect", "elastic", "none"):
        simulation = Simulation(
            np.zeros((2, 3)), np.zeros((2, 3)), [0.5, 0.5], [1, 1], [1, 1, 1], response, record=True
        )
        assert simulation.advance(1e9)
        assert len(simulation.events) == 0
        assert simulation.time == 1e9


@pytest.mark.parametrize("n", [0, 1])
def test_no_body_and_a_single_sphere_are_runs_too(n):
    simulation = Simulation(np.zeros((n, 3)), np.ones((n, 3)), np.full(n, 0.5), np.ones(n), [1.5, 1.5, 1.5])
    simulation.advance(10.0)
    assert simulation.counters["pair_hits"] == 0
    assert simulation.counters["box_hits"] == (15 if n else 0)
    assert simulation.positions.shape == (n, 3)


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
def test_event_times_are_those_of_fifty_digit_arithmetic(response):
    """Within 1e-12 for the first dozen hits of a crowded little box, before rounding has had time to grow."""
    rng = np.random.default_rng(21)
    positions = (np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.9).astype(float)
    positions += rng.uniform(-0.2, 0.2, positions.shape)
    velocities, radii, half = rng.normal(size=(8, 3)), rng.uniform(0.3, 0.6, 8), np.array([1.9, 2.0, 2.1])
    simulation = Simulation(positions, velocities, radii, radii**3, half, response, record=True)
    simulation.advance(np.inf, max_events=30)

    def decimals(array):
        return [decimals(row) for row in array] if np.ndim(array) else Decimal(float(array))

    with localcontext() as context:
        context.prec = 50
        exact = Reference(
            decimals(positions),
            decimals(velocities),
            decimals(radii),
            decimals(radii**3),
            decimals(half),
            response,
            root=Decimal.sqrt,
        )
        for _ in range(30):
            exact.step()
    found = simulation.events
    assert [(e["kind"], e["i"], e["wall"] if e["kind"] == Event.WALL else e["j"]) for e in found] == [
        e[1:] for e in exact.events
    ]
    errors = [abs(float(Decimal(float(e["time"])) - x[0])) for e, x in zip(found, exact.events, strict=True)]
    assert max(errors) <= 1e-12
    assert np.allclose(simulation.velocities, np.array(exact.v, dtype=float), atol=1e-11)
