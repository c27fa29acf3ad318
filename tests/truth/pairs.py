"""Pairs of bodies for the tests of proofs."""

from fractions import Fraction

import numpy as np

from harness.scene.mesh import Surface
from harness.truth.cases import Cases
from harness.truth.flights import Flights
from harness.truth.solids import Solids

CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ],
    np.int32,
)
CUBE = Surface(CORNERS, FACES)
SOLIDS = Solids({"cube": CUBE}, [("cube", "mesh"), ("cube", "hull"), ("", "sphere")])


def flight(solid, *, size=1.0, position=(0, 0, 0), quaternion=(1, 0, 0, 0), velocity=(0, 0, 0), spin=(0, 0, 0)):
    """One body."""
    rows = [np.array([row], float) for row in (position, quaternion, velocity, spin)]
    return Flights(np.array([solid]), np.array([size]), *rows)


def case(first, second, lower, upper, window=10.0):
    """One pair and what is claimed of it; `upper` inf for never."""
    bounds = [np.array([float(number)]) for number in (window, lower, upper)]
    return Cases(np.array(["test"]), first, second, *bounds)


def around(time, width=8e-10):
    """Bounds around a time that is known as a fraction or a float."""
    return float(Fraction(time) - Fraction(width) / 2), float(Fraction(time) + Fraction(width) / 2)
