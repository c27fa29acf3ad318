"""The colour, the marker and the letter of a method: the same on all pages."""

from __future__ import annotations

import math
from collections.abc import Mapping

from harness.report.drawing import palette
from harness.vocabulary import ALGORITHMS, MethodName

# The first places are for algorithms of this program, in the order of the vocabulary; then come backends' own. Events
# stand apart from all that steps, in a colour of their own, and so do backends that come in the default sweep. The
# others share one.
_EVENTS = 3
_BACKENDS = {"pybullet": 5, "coal": 6, "mujoco": 7, "trimesh": 8, "fcl": 10}
_LATER = 9


def style_of(method: MethodName) -> int:
    """The number of a method's colour and marker.

    >>> style_of(MethodName.read("fcl/grid", "hull")), style_of(MethodName.read("pybullet", "hull"))
    (1, 5)
    """
    own = _own()
    if method.algorithm not in own:
        return _BACKENDS.get(method.backend, _LATER)
    if not method.stepped:
        return _EVENTS
    place = own.index(method.algorithm)
    place += place >= _EVENTS
    return place if place < min(_BACKENDS.values()) else place + len(_BACKENDS) + 1


def styles_of(methods: Mapping[str, MethodName]) -> dict[str, int]:
    """The style of each series: that of its method; of a further one of the same method the same colour, if possible.

    Where one method is all there is, the series are numbered.

    Parameters
    ----------
    methods : by what the series are called
    """
    of_methods = {label: style_of(method) for label, method in methods.items()}
    if len(set(of_methods.values())) == 1 < len(of_methods):
        return {label: place for place, label in enumerate(methods)}
    found: dict[str, int] = {}
    reserved = set(of_methods.values())
    for label, style in of_methods.items():
        further = [style, *(other for other in same_colour(style) if other not in reserved), *range(88, 240)]
        found[label] = next(other for other in further if other not in found.values())
    return found


def same_colour(style: int) -> list[int]:
    """Styles of the same colour with the other markers.

    >>> same_colour(1)
    [12, 23, 34, 45, 56, 67, 78]
    """
    colours, both = len(palette.LIGHT), math.lcm(len(palette.LIGHT), len(palette.MARKERS))
    return [(style + step) % both for step in range(colours, both, colours)]


def letter(method: MethodName) -> str:
    """Its letter on a map: of an algorithm of this program one, of a backend's own detection its first two.

    >>> letter(MethodName.read("fcl/grid", "hull")), letter(MethodName.read("pybullet", "hull"))
    ('G', 'Py')
    """
    taken: dict[str, str] = {}
    for name in _own():
        taken[name] = next((mark for mark in name.upper() if mark.isalpha() and mark not in taken.values()), name)
    return taken.get(method.algorithm, method.backend[:2].capitalize())


def _own() -> list[str]:
    """Algorithms of this program, those that step first."""
    return sorted(
        (name for name, word in ALGORITHMS.items() if word.own), key=lambda name: not ALGORITHMS[name].stepped
    )
