"""Measures a run as a gas: collision rate, pressure, virial balance, and kinetic theory beside them.

Rate and pressure are those of the time after `begin`, when the start is forgotten; the balance is exact at any time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.arrays import Floats
from harness.measure.theory import pair_impulse, wall_pressure
from harness.scene.scene import Scene


class Gas(Protocol):
    """What is asked of a simulation."""

    time: float

    @property
    def counters(self) -> dict[str, int]:
        """At least `pair_hits`."""

    @property
    def wall_impulses(self) -> Floats:
        """(6,) impulses given to the walls so far, kg m/s."""

    @property
    def pair_impulses(self) -> float:
        """Sum over pair hits so far of |impulse| times the distance of centres, kg m²/s."""

    @property
    def kinetic_energy(self) -> float:
        """J."""

    @property
    def virial_residual(self) -> float:
        """Imbalance of the virial theorem over the whole run, relative."""


@dataclass(frozen=True)
class _Reading:
    time: float
    pair_hits: int
    wall_impulse: float
    pair_impulse: float


class Kinetics:
    """Reads a simulation twice, and reports what happened between.

    Parameters
    ----------
    scene : Scene
    response, restitution : of the run; the virial is of elastic hits, and pressure and theory of spheres
    """

    def __init__(self, scene: Scene, response: str, restitution: float) -> None:
        self._sizes, self._masses, self._sides = scene.bodies.sizes, scene.bodies.masses, scene.box.sides
        self._spheres = scene.shape == "sphere"
        self._elastic = response == "elastic" and restitution == 1.0
        self._answered = response != "none"
        self._first: _Reading | None = None

    def begin(self, gas: Gas) -> None:
        """Start measuring rates."""
        self._first = _read(gas)

    def end(self, gas: Gas) -> dict[str, float]:
        """The metrics that the run allows; theory only for equal elastic spheres that fit well into their box."""
        metrics: dict[str, float] = {}
        first, last = self._first, _read(gas)
        if first is None or last.time <= first.time or len(self._sizes) < 2 or not self._answered:
            return metrics
        time, hits = last.time - first.time, last.pair_hits - first.pair_hits
        metrics["collision_rate"] = 2.0 * hits / (len(self._sizes) * time)
        if self._elastic:
            metrics["virial_residual"] = abs(gas.virial_residual)
        if not self._spheres:
            return metrics
        reach = self._sides - self._sizes.mean()
        area = 2.0 * float(reach[0] * reach[1] + reach[1] * reach[2] + reach[2] * reach[0])
        if (reach <= 0.0).any():
            return metrics
        pressure = (last.wall_impulse - first.wall_impulse) / (time * area)
        metrics["pressure"] = pressure
        if not self._elastic:
            return metrics
        temperature = 2.0 * gas.kinetic_energy / (3.0 * len(self._sizes))
        if np.ptp(self._sizes) == 0.0 and np.ptp(self._masses) == 0.0 and temperature > 0.0:
            diameter, mass = float(self._sizes[0]), float(self._masses[0])
            if hits:
                mean = (last.pair_impulse - first.pair_impulse) / hits
                metrics["pair_impulse_to_theory"] = mean / pair_impulse(diameter, mass, temperature)
            try:
                theory = wall_pressure(len(self._sizes), diameter, temperature, self._sides)
            except ValueError:
                return metrics  # a solid: no theory of fluids holds
            metrics["pressure_to_theory"] = pressure / theory
        return metrics


def _read(gas: Gas) -> _Reading:
    return _Reading(gas.time, gas.counters["pair_hits"], float(gas.wall_impulses.sum()), gas.pair_impulses)
