"""Kinetic theory against its limits."""

import numpy as np
import pytest

from harness.measure.theory import bulk_pressure, compressibility, pair_impulse, surface_tension, wall_pressure


def test_a_dilute_gas_is_ideal():
    assert compressibility(0.0) == 1.0
    assert bulk_pressure(1e-9) == pytest.approx(6e-9 / np.pi, rel=1e-8)
    assert surface_tension(0.0) == 0.0


def test_the_virial_series_agrees_where_it_converges():
    coefficients = (1, 4, 10, 18.3648, 28.2245, 39.8151, 53.3444, 68.538, 85.813, 105.8)
    for packing in (0.05, 0.1, 0.2, 0.3):
        series = sum(b * packing**k for k, b in enumerate(coefficients))
        assert compressibility(packing) == pytest.approx(series, rel=3e-3)


def test_a_single_sphere_presses_as_an_ideal_gas_in_the_room_it_has():
    sides = np.array([11.0, 11.0, 11.0])
    assert wall_pressure(1, 1.0, 2.0, sides) == pytest.approx(2.0 / 1000, rel=0.02)


def test_walls_matter_less_in_a_larger_box():
    nominal = bulk_pressure(0.3)
    excess = [
        wall_pressure(count, 1.0, 1.0, np.full(3, (count * np.pi / 6 / 0.3) ** (1 / 3))) / nominal - 1
        for count in (10**3, 10**4, 10**5, 10**9)
    ]
    assert excess == sorted(excess, reverse=True)
    assert excess[0] > 0.4
    assert excess[-1] < 0.005


def test_pressure_scales_with_units():
    sides = np.array([9.0, 10.0, 12.0])
    base = wall_pressure(300, 1.0, 1.0, sides)
    assert wall_pressure(300, 2.0, 3.0, 2 * sides) == pytest.approx(base * 3 / 8)
    assert wall_pressure(300, 1.0, 1.0, sides[::-1]) == pytest.approx(base)


def test_a_solid_has_no_theory_of_fluids():
    with pytest.raises(ValueError, match="too dense"):
        wall_pressure(1000, 1.0, 1.0, np.full(3, 9.0))


def test_the_mean_impulse_is_that_of_a_maxwell_gas():
    assert pair_impulse(2.0, 3.0, 5.0) == pytest.approx(2.0 * np.sqrt(np.pi * 15.0))
