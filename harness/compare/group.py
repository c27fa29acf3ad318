"""The methods that are held against the same solids: each is loaded and asked once a pose, however many they are.

A method that holds hulls of its own is held against the others on those hulls, which are given to them; methods
without, and two that both hold their own, on the hulls of the scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import combinations

from harness.compare.isolated import LARGEST_TOLERANCE, BrokenError, Facts, HangingError, Isolated, UnusableError
from harness.compare.question import COLLISION, Question
from harness.compare.tally import NamePair
from harness.scene.hull import Hull, hull_of, is_closed_and_convex, outside
from harness.scene.scene import Scene


@dataclass(frozen=True)
class Group:
    """Methods loaded with the same scene.

    Parameters
    ----------
    scene : with the hulls that they are held against
    asked : by name, in the order in which they are asked
    pairs : those of them that are held against each other
    """

    scene: Scene
    asked: dict[str, Isolated]
    pairs: tuple[NamePair, ...]


@dataclass(frozen=True)
class Loaded:
    """All methods that could load a scene.

    Parameters
    ----------
    groups : one for each set of hulls
    unusable : by name, why it cannot take the scene
    claims : by name, what it says of itself that cannot be accepted
    broken : those among the unusable that failed over it
    hanging : those among the broken that did not end
    """

    groups: tuple[Group, ...]
    unusable: dict[str, str]
    claims: dict[str, str]
    broken: frozenset[str]
    hanging: frozenset[str]


def load(
    scene: Scene, names: Sequence[str], processes: ExitStack, timeout: float, question: Question = COLLISION
) -> Loaded:
    """Every method with the scene; and with the hulls of another, where it is held against those."""
    asked: dict[str, Isolated] = {}
    unusable: dict[str, str] = {}
    claims: dict[str, str] = {}
    broken: set[str] = set()
    hanging: set[str] = set()

    def enter(name: str, held: Scene) -> Isolated | None:
        try:
            return processes.enter_context(Isolated(name, held, timeout, question))
        except UnusableError as error:
            unusable[name] = str(error)
            if isinstance(error, BrokenError):
                broken.add(name)
            if isinstance(error, HangingError):
                hanging.add(name)
            return None

    for name in names:
        entered = enter(name, scene)
        if entered is not None:
            asked[name] = entered
            claim = unacceptable(entered.facts, scene)
            if claim is not None:
                claims[name] = claim
    holders = [name for name in asked if asked[name].facts.hulls and name not in claims]
    pairs = list(combinations(asked, 2))
    groups = [Group(scene, asked, tuple(pair for pair in pairs if sum(name in holders for name in pair) != 1))]
    for holder in holders:
        held = replace(scene, hulls=asked[holder].facts.hulls)
        mine = [pair for pair in pairs if holder in pair and sum(name in holders for name in pair) == 1]
        others = {name for pair in mine for name in pair} - {holder}
        again: dict[str, Isolated] = {}
        for name in asked:
            entered = asked[name] if name == holder else enter(name, held) if name in others else None
            if entered is not None:
                again[name] = entered
        groups.append(Group(held, again, tuple(pair for pair in mine if set(pair) <= set(again))))
    return Loaded(
        tuple(group for group in groups if group.pairs), unusable, claims, frozenset(broken), frozenset(hanging)
    )


def unacceptable(facts: Facts, scene: Scene) -> str | None:
    """What a backend says of itself that leaves nothing to hold it to; None if all can be accepted."""
    for tolerance, what in ((facts.tolerance, "tolerance"), (facts.hulls_tolerance, "tolerance for its own hulls")):
        if not 0.0 <= tolerance <= LARGEST_TOLERANCE:
            return f"it declares a {what} of {tolerance:g} of a size; at most {LARGEST_TOLERANCE:g} is accepted"
    held = set(scene.solids)
    for (mesh, size), hull in facts.hulls.items():
        if (mesh, size) not in held:
            return f"it declares a hull of its own for {size} m of mesh {mesh}, which no body of the scene has"
        if not is_closed_and_convex(hull, _ROUNDED * size):
            return f"its hull of a body of {size:g} m is no closed convex surface with these vertices"
        solid = scene.solid_of(size, mesh)
        off = _apart(hull, hull_of(solid.vertices, solid.faces)) / size
        if not off <= facts.tolerance:
            return (
                f"its hull of a body of {size:g} m is {off:.2g} of the size off the scene's; it declares a tolerance "
                f"of {facts.tolerance:g}"
            )
    return None


# Of a size: by how much vertices of a hull may be outside of its own faces, whose normals a sliver rounds.
_ROUNDED = 1e-6


def _apart(hull: Hull, other: Hull) -> float:
    """m, how far a vertex of either convex solid lies outside of the other, along the normal of a face."""
    return max(outside(hull.vertices, other), outside(other.vertices, hull))
