"""What ought to stay constant in a motion, and how far it drifts."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats
from harness.kernel import kernel
from harness.scene.bodies import Bodies


class Conservation:
    """Follows the translational energy of bodies through a run.

    Attributes
    ----------
    energy_drift : float
        Largest |E - E0| / E0 observed; 0 where E0 is 0.
    momentum_drift : float
        Largest change of the total momentum observed, less what the walls gave, of the sum of m|v| at the start; 0
        where that is 0.
    """

    def __init__(self, bodies: Bodies) -> None:
        self._masses = bodies.masses
        self._start = energy(bodies.velocities, bodies.masses)
        self._momentum = bodies.masses @ bodies.velocities
        self.momentum_scale = float(bodies.masses @ np.linalg.norm(bodies.velocities, axis=1))
        self.energy_drift = 0.0
        self.momentum_drift = 0.0

    def observe(self, velocities: Floats) -> None:
        """Take note of the energy at these velocities, (n, 3) m/s."""
        if self._start > 0.0:
            now = energy(velocities, self._masses)
            # not max(): a velocity that is no number must show, not vanish in a comparison
            drift = abs(now - self._start) / self._start
            if not drift <= self.energy_drift:
                self.energy_drift = drift

    def observe_momentum(self, velocities: Floats, wall_impulses: Floats) -> None:
        """Take note of the momentum at these velocities, (n, 3) m/s, after so much from x-, x+, … (6,), kg m/s."""
        if self.momentum_scale > 0.0:
            from_walls = wall_impulses[0::2] - wall_impulses[1::2]
            change = self._masses @ velocities - self._momentum - from_walls
            drift = float(np.linalg.norm(change)) / self.momentum_scale
            if not drift <= self.momentum_drift:
                self.momentum_drift = drift


@kernel
def energy(velocities: Floats, masses: Floats) -> float:
    """Translational energy, J: the sum of m v²/2 over velocities (n, 3) in m/s and masses (n,) in kg."""
    total = 0.0
    rounded_off = 0.0
    for i in range(len(masses)):
        x, y, z = velocities[i]
        term = 0.5 * masses[i] * (x * x + y * y + z * z)
        # Neumaier's sum: mass ratios of 1e12 must not round the light bodies away
        after = total + term
        rounded_off += (total - after) + term if abs(total) >= abs(term) else (term - after) + total
        total = after
    return total + rounded_off
