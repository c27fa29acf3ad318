"""The colour, the marker and the letter of a method: the same on all pages."""

from __future__ import annotations

import math

from harness.report.drawing import palette
from harness.vocabulary import ALGORITHMS, MethodName

# Methods of this program in the order in which they came to be, then backends' own; six colours and eight markers.
_PLACES = {name: place for place, name in enumerate(("brute-force", "grid", "predictive", "tree", "sap"))}
_BACKENDS = {name: place for place, name in enumerate(("fcl", "pybullet", "coal", "mujoco", "trimesh"), start=5)}
_LATER = 10
_LETTERS = {"brute-force": "B", "grid": "G", "predictive": "P", "tree": "T", "sap": "S"}


def style_of(method: MethodName) -> int:
    """The number of a method's colour and marker.

    >>> style_of(MethodName.read("fcl/grid", "hull")), style_of(MethodName.read("pybullet", "hull"))
    (1, 6)
    """
    if method.algorithm in _PLACES:
        return _PLACES[method.algorithm]
    if method.algorithm == "native":
        return _BACKENDS.get(method.backend, _LATER)
    later = [name for name in ALGORITHMS if name not in _PLACES]
    return _LATER + (later.index(method.algorithm) if method.algorithm in later else len(later))


def same_colour(style: int) -> list[int]:
    """Styles of the same colour with the other markers.

    >>> same_colour(1)
    [7, 13, 19]
    """
    colours, both = len(palette.LIGHT), math.lcm(len(palette.LIGHT), len(palette.MARKERS))
    return [(style + step) % both for step in range(colours, both, colours)]


def letter(method: MethodName) -> str:
    """Its letter on a map: of an algorithm of this program one, of a backend's own detection its first two.

    >>> letter(MethodName.read("fcl/grid", "hull")), letter(MethodName.read("pybullet", "hull"))
    ('G', 'Py')
    """
    if method.algorithm == "native":
        return method.backend[:2].capitalize()
    return _LETTERS.get(method.algorithm, method.algorithm[:2].capitalize())
