"""From a declaration to its points: the product of the axes, less what is excluded, plus what is included.

The first axis varies slowest. Where nothing varies, the base is the one point, unless whole points are included: then
they are all there is. Points that come out the same are one point.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from harness.experiment.combinations import AbilitiesOf, Conflict, Rule, conflicts, point_rules
from harness.experiment.declaration import Axis, Declaration, ExcludeRow, LeafValue
from harness.experiment.document import KEY
from harness.experiment.experiment import Point, Reference
from harness.experiment.leaves import INSTEAD_OF, LEAVES, SECTIONS, identity
from harness.experiment.messages import flow, listed
from harness.experiment.problems import FileProblems, Origin
from harness.experiment.schema import MeasureSpec, ReferenceSpec
from harness.vocabulary import NEAR_QUERIES, Shape

# All points are held in memory, a few kilobytes each.
MOST_POINTS = 10**5
# Combinations times rows of `exclude`: more are not gone through, even if few points would be left.
MOST_COMPARISONS = 10**7

Resolved = dict[str, LeafValue]
# What recorded poses say, or have no use of.
TOLD_BY_POSES = ("duration", "dt", "response", "restitution", "speed", "spin", "overlap")
_EXACT_FIRST: tuple[Shape, ...] = ("mesh", "hull", "sphere")
DEFAULTS: Resolved = {name: LeafValue(leaf.default, None, identity(leaf.default)) for name, leaf in LEAVES.items()}


@dataclass
class Expansion:
    """The points, the leaves that vary, and where each leaf's values come from (by leaf and identity)."""

    points: tuple[Point, ...] = ()
    swept: tuple[str, ...] = ()
    origins: dict[tuple[str, str], Origin] = field(default_factory=dict)


def expand(
    declaration: Declaration,
    measure: MeasureSpec,
    problems: FileProblems,
    abilities_of: AbilitiesOf | None = None,
) -> Expansion:
    """All points of a checked declaration; none if there are problems.

    Too many runs are refused by the lengths of the lists, before any point is made. Without `abilities_of`, what
    backends can be asked is not looked at.
    """
    axes = [_without_duplicates(axis) for axis in declaration.axes]
    varied = bool(axes) or not declaration.include
    if refusal := _too_many_to_make(declaration, axes, measure, varied):
        problems.add(_varying_key(problems), refusal)
        return Expansion()
    base = _over(DEFAULTS, declaration.base)
    most = min(measure.max_runs // measure.repeats, MOST_POINTS)
    kept = _kept(declaration, axes, base, problems, most) if varied else []
    if len(kept) > most:
        message = f"exclude leaves more than {most} points, with {measure.repeats} repeats more than measure.max_runs"
        problems.add(_varying_key(problems), f"{message}, which is {measure.max_runs}; vary less, or raise it")
        return Expansion()
    product_points = [_over(base, combination) for combination in kept]
    included = [_over(base, row) for row in declaration.include]
    product_points, included = (_recorded(points, problems) for points in (product_points, included))
    resolved = [*product_points, *included]
    if refusal := _too_many(axes, len(resolved) * measure.repeats, measure):
        problems.add(_varying_key(problems), refusal)
        return Expansion()
    if not resolved:
        problems.add(("exclude", KEY), "every point is excluded")
    varying = {leaf for axis in axes if len(axis.rows) > 1 for leaf in axis.leaves}
    rules = point_rules(abilities_of)
    _add_conflicts(product_points, rules, varying, problems)
    for point in included:
        _add_conflicts([point], rules, set(), problems)
    expansion = Expansion(origins=_origins(resolved))
    if problems.found:
        return expansion
    mentioned = [leaf for leaves in (*(axis.leaves for axis in axes), *declaration.include) for leaf in leaves]
    first: dict[tuple[str | None, ...], Resolved] = {}
    for point in resolved:
        first.setdefault(_key(point), point)
    unique = list(first.values())
    _require_measurable(unique, measure, problems)
    if not problems.found:
        expansion.points = tuple(_points(unique, measure.reference))
        expansion.swept = _swept(unique, mentioned)
    return expansion


def _too_many_to_make(declaration: Declaration, axes: list[Axis], measure: MeasureSpec, varied: bool) -> str | None:
    """Why so many combinations are refused before any is made, if they are."""
    combinations, rows = math.prod(len(axis.rows) for axis in axes), len(declaration.exclude)
    if not rows:
        return _too_many(axes, (combinations * varied + len(declaration.include)) * measure.repeats, measure)
    if combinations * rows > MOST_COMPARISONS:
        return f"{combinations} combinations are too many to hold against {rows} rows of exclude; vary less"
    return None


def _require_measurable(points: Sequence[Resolved], measure: MeasureSpec, problems: FileProblems) -> None:
    """Report what is to be measured of points that do not have it."""
    if measure.reference is not None and any(map(_has_no_reference, points)):
        message = "a reference knows gaps of recorded poses and no hits: choose query tolerance or distance"
        problems.add(("measure", "reference", KEY), message)
    elif "resting" in measure.families and any(point["poses"].value is None for point in points):
        message = "the family resting is of recorded poses, and motion.poses names none; record some, or leave it out"
        problems.add(("measure", "families", KEY), message)


def _without_duplicates(axis: Axis) -> Axis:
    rows: dict[Any, tuple[LeafValue, ...]] = {}
    for place, row in enumerate(axis.rows):
        identities = tuple(given.identity for given in row)
        rows.setdefault(place if None in identities else identities, row)
    return Axis(axis.leaves, list(rows.values()))


def _varying_key(problems: FileProblems) -> Origin:
    """The place to correct where too much varies."""
    file = problems.document.value
    return (next((key for key in ("sweep", "zip", "include") if file.get(key)), "sweep"), KEY)


def _too_many(axes: list[Axis], runs: int, measure: MeasureSpec) -> str | None:
    """Why so many runs are refused, if they are."""
    if runs <= measure.max_runs:
        points = runs // measure.repeats
        return f"{points} points are too many; there can be {MOST_POINTS}" if points > MOST_POINTS else None
    lengths = " x ".join(f"{len(axis.rows)} {'/'.join(axis.leaves)}" for axis in axes)
    return (
        f"{runs} runs ({lengths or 'include'}, {measure.repeats} repeats) are more than measure.max_runs, "
        f"which is {measure.max_runs}; vary less, or raise it"
    )


def _over(under: Resolved, over: Resolved) -> Resolved:
    """Values over others; one that stands instead of another takes that one away."""
    replaced = {INSTEAD_OF[leaf] for leaf in over if leaf in INSTEAD_OF} - set(over)
    return {**under, **{leaf: DEFAULTS[leaf] for leaf in replaced}, **over}


def _kept(
    declaration: Declaration, axes: list[Axis], base: Resolved, problems: FileProblems, most: int
) -> list[Resolved]:
    """The combinations of the axes that no row of `exclude` matches; one more than `most` if there are too many."""
    over = {leaf: given for axis in axes for leaf, given in zip(axis.leaves, axis.rows[0], strict=True)}
    matchers = [_Matcher(row, axes, _over(base, over)) for row in declaration.exclude]
    kept: list[Resolved] = []
    for places in product(*(range(len(axis.rows)) for axis in axes)):
        matches = [matcher.matches(places) for matcher in matchers]
        if not any(matches):
            chosen = (zip(axis.leaves, axis.rows[place], strict=True) for axis, place in zip(axes, places, strict=True))
            kept.append({leaf: given for pairs in chosen for leaf, given in pairs})
            if len(kept) > most:
                return kept
    for matcher in matchers:
        if not matcher.matched and not matcher.uncertain and not declaration.narrowed:
            problems.add(matcher.row.path, f"this row excludes nothing{matcher.reason()}")
    return kept


class _Matcher:
    """A row of `exclude`, prepared to be matched against places along the axes."""

    def __init__(self, row: ExcludeRow, axes: list[Axis], base: Resolved) -> None:
        self.row = row
        self.matched = False
        self.possible = True
        self.never: str | None = None  # a leaf that never has any of the row's values
        self.places: list[tuple[int, frozenset[int]]] = []
        compared = [given for leaf_values in row.values.values() for given in leaf_values]
        for leaf, leaf_values in row.values.items():
            wanted = {given.identity for given in leaf_values}
            number = next((place for place, axis in enumerate(axes) if leaf in axis.leaves), None)
            if number is None:
                compared.append(base[leaf])
                matching = base[leaf].identity in wanted
                self.possible &= matching
            else:
                column = axes[number].leaves.index(leaf)
                values = [rows[column] for rows in axes[number].rows]
                compared.extend(values)
                places = frozenset(place for place, given in enumerate(values) if given.identity in wanted)
                self.places.append((number, places))
                matching = bool(places)
            if not matching:
                self.never = leaf
        # A wrong value is reported at its own place; what it would have matched is not known.
        self.uncertain = not row.values or any(given.identity is None for given in compared)
        self.possible &= not self.uncertain

    def matches(self, places: tuple[int, ...]) -> bool:
        matching = self.possible and all(places[axis] in wanted for axis, wanted in self.places)
        self.matched |= matching
        return matching

    def reason(self) -> str:
        if self.never is None:
            return ": no point has all of these values"
        leaf_values = self.row.values[self.never]
        return (
            f": {self.never} is never {listed([flow(given.value) for given in leaf_values], 'or')}"
            if leaf_values
            else ""
        )


def _add_conflicts(
    points: Iterable[Resolved], rules: Sequence[Rule], varying: set[str], problems: FileProblems
) -> None:
    """Report each kind of conflict once, with the `exclude` row that would take all of its points out."""
    kinds: dict[tuple[Any, ...], tuple[Conflict, Resolved, dict[str | None, Any]]] = {}
    for point in points:
        values = {leaf: given.value for leaf, given in point.items() if given.identity is not None}
        for conflict in conflicts(values, rules):
            fixed = tuple(point[leaf].identity for leaf in conflict.leaves[:-1]) if conflict.excludable else ()
            _, _, last = kinds.setdefault((conflict.message, *fixed), (conflict, point, {}))
            last.setdefault(point[conflict.leaves[-1]].identity, values[conflict.leaves[-1]])
    for conflict, point, last in kinds.values():
        message = conflict.message.replace("{}", listed([flow(value) for value in last.values()], "or"))
        if conflict.excludable and varying.intersection(conflict.leaves):
            row = {leaf: point[leaf].value for leaf in conflict.leaves}
            row[conflict.leaves[-1]] = list(last.values()) if len(last) > 1 else row[conflict.leaves[-1]]
            message += f"; leave it out with `exclude: - {flow(row)}`"
        problems.add(_origin_of(conflict, point, varying), message)


def _origin_of(conflict: Conflict, point: Resolved, varying: set[str]) -> Origin:
    """The value to mend: the last that varies, else the last that is given, else the section it is missing from."""
    by_need = [leaf for varies in (True, False) for leaf in conflict.leaves[::-1] if (leaf in varying) is varies]
    origins = (origin for leaf in by_need if (origin := point[leaf].origin) is not None)
    return next(origins, (LEAVES[conflict.leaves[-1]].section, KEY))


def _origins(points: Iterable[Resolved]) -> dict[tuple[str, str], Origin]:
    origins: dict[tuple[str, str], Origin] = {}
    for point in points:
        for leaf, given in point.items():
            if given.origin is not None and given.identity is not None:
                origins.setdefault((leaf, given.identity), given.origin)
    return origins


def _key(point: Resolved) -> tuple[str | None, ...]:
    return tuple(point[leaf].identity for leaf in LEAVES)


def _points(resolved: Sequence[Resolved], reference: ReferenceSpec | None) -> Iterator[Point]:
    """Points; equal scenes, motions and engines are one object."""
    shapes = {point["shape"].value for point in resolved if _has_a_mesh(point)}
    most_exact: Shape = next((shape for shape in _EXACT_FIRST if shape in shapes), "sphere")
    made: dict[tuple[str | None, ...], Any] = {}
    for point in resolved:
        parts = {}
        for section, model in SECTIONS.items():
            key = (section, *(point[leaf].identity for leaf in model.model_fields))
            if key not in made:
                made[key] = model(**{leaf: point[leaf].value for leaf in model.model_fields})
            parts[section] = made[key]
        shape: Shape = most_exact if parts["scene"].mesh_names else "sphere"
        yield Point(**parts, reference=Reference(reference, shape) if reference else None)


def _recorded(points: list[Resolved], problems: FileProblems) -> list[Resolved]:
    """Points whose poses are recorded have no response; what else they tell may not be given beside them.

    Of others each body has a place.
    """
    found, looked_at = [], set()
    for point in points:
        if point["poses"].value is None:
            if point["bodies"].identity not in looked_at:
                looked_at.add(point["bodies"].identity)
                _require_places(point["bodies"], problems)
            found.append(point)
            continue
        for leaf in TOLD_BY_POSES:
            origin = point[leaf].origin
            if origin is not None and not (leaf == "response" and point[leaf].value == "none"):
                problems.add(origin, f"{leaf} has no effect with poses, which tell all motion; leave it out")
        found.append({**point, "response": LeafValue("none", None, identity("none"))})
    return found


def _require_places(bodies: LeafValue, problems: FileProblems) -> None:
    for number, body in enumerate(bodies.value or () if bodies.identity is not None else ()):
        if body.position is None and bodies.origin is not None:
            place = (*bodies.origin, number) if isinstance(bodies.origin, tuple) else bodies.origin
            problems.add(place, '"position" is missing')


def _has_no_reference(point: Resolved) -> bool:
    return point["poses"].value is not None and point["query"].value not in NEAR_QUERIES


def _has_a_mesh(point: Resolved) -> bool:
    own = (body.mesh for body in point["bodies"].value or ())
    return point["mesh"].value is not None or any(name is not None for name in own)


def _swept(points: list[Resolved], mentioned: list[str]) -> tuple[str, ...]:
    """The leaves with more than one value, in the order the file mentions them."""
    varying = [leaf for leaf in LEAVES if len({point[leaf].identity for point in points}) > 1]
    return tuple(leaf for leaf in dict.fromkeys([*mentioned, *varying]) if leaf in varying)
