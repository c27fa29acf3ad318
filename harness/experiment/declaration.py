"""What a file declares to run: values of the base point, axes that vary, and rows that take points out or add some."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from harness.experiment.document import KEY, KeyPath
from harness.experiment.leaves import INSTEAD_OF, LEAVES, SECTIONS, identity, unknown_key, unknown_leaf
from harness.experiment.messages import listed, near, shown
from harness.experiment.problems import FileProblems, Origin, Override


@dataclass(frozen=True)
class LeafValue:
    """A leaf's value and where it comes from (None: it is the default).

    `identity` is the same text for the same value; None while the value is not checked, or if it is wrong.
    """

    value: Any
    origin: Origin | None
    identity: str | None = None


@dataclass
class Axis:
    """Leaves that vary together, and the rows of values they take."""

    leaves: tuple[str, ...]
    rows: list[tuple[LeafValue, ...]]


@dataclass
class ExcludeRow:
    """Points with one of these values for each of these leaves are taken out."""

    path: KeyPath
    values: dict[str, list[LeafValue]]


@dataclass
class Declaration:
    """What a file declares to run.

    `narrowed`: leaves were set outside of the file, so that a row of `exclude` may match nothing any more.
    """

    base: dict[str, LeafValue] = field(default_factory=dict)
    axes: list[Axis] = field(default_factory=list)
    exclude: list[ExcludeRow] = field(default_factory=list)
    include: list[dict[str, LeafValue]] = field(default_factory=list)
    narrowed: bool = False

    def axis_of(self, leaf: str) -> Axis | None:
        """The axis that a leaf varies along."""
        return next((axis for axis in self.axes if leaf in axis.leaves), None)


def declare(file: Mapping[str, Any], problems: FileProblems) -> Declaration:
    """Read the sections of a file that say what to run. Names are checked, values are not yet: see `check`."""
    declaration = Declaration()
    for section, model in SECTIONS.items():
        for name, value in _mapping(file.get(section), (section,), problems).items():
            if name in model.model_fields:
                declaration.base[name] = LeafValue(value, (section, name))
            else:
                problems.add((section, name, KEY), unknown_key(name, model.model_fields))
    for name, values in _leaves(file.get("sweep"), ("sweep",), problems):
        if _is_values(values, ("sweep", name), problems):
            leaf_values = [LeafValue(value, ("sweep", name, place)) for place, value in enumerate(values)]
            declaration.axes.append(Axis((name,), [(given,) for given in leaf_values]))
    for block, columns in enumerate(_list(file.get("zip"), ("zip",), problems)):
        _read_block(declaration, columns, ("zip", block), problems)
    for place, row in enumerate(_list(file.get("exclude"), ("exclude",), problems)):
        path: KeyPath = ("exclude", place)
        values = {name: _any_of(name, value, (*path, name)) for name, value in _leaves(row, path, problems)}
        if not values and isinstance(row, dict | None) and not row:
            problems.add(path, "an empty row would exclude every point")
        declaration.exclude.append(ExcludeRow(path, values))
    for place, row in enumerate(_list(file.get("include"), ("include",), problems)):
        path = ("include", place)
        leaves = dict(_leaves(row, path, problems))
        if isinstance(row, dict) and len(leaves) == len(row):
            declaration.include.append({name: LeafValue(value, (*path, name)) for name, value in leaves.items()})
    return declaration


def apply_override(declaration: Declaration, override: Override, value: Any, problems: FileProblems) -> None:
    """Override a leaf: in the base, in place of its list where it varies, and in the rows of `include`."""
    name = override.leaf
    many = LEAVES[name].holds_many(value)
    leaf_values = [LeafValue(item, override) for item in (value if many else [value])]
    if not leaf_values:
        problems.add(override, "needs at least one value")
        return
    declaration.narrowed = True
    if name in INSTEAD_OF:
        _remove(declaration, INSTEAD_OF[name])
    axis = declaration.axis_of(name)
    if axis is not None and len(axis.leaves) > 1:
        if len(leaf_values) not in (1, len(axis.rows)):
            others = len(axis.rows)
            problems.add(override, f"needs 1 or {others} values, for it varies together with other leaves")
            return
        column = axis.leaves.index(name)
        new = leaf_values if len(leaf_values) > 1 else leaf_values * len(axis.rows)
        rows = zip(axis.rows, new, strict=True)
        axis.rows = [(*row[:column], given, *row[column + 1 :]) for row, given in rows]
    elif axis is not None:
        axis.rows = [(given,) for given in leaf_values]
    elif many:
        declaration.axes.append(Axis((name,), [(given,) for given in leaf_values]))
    if not many:
        declaration.base[name] = leaf_values[0]
        for row in declaration.include:
            if name in row:
                row[name] = leaf_values[0]


def check(declaration: Declaration, problems: FileProblems) -> None:
    """Turn every value into its leaf's type, and report those that have no such type."""

    def typed(name: str, given: LeafValue) -> LeafValue:
        if given.origin is None:
            return given
        try:
            value = LEAVES[name].check(given.value)
        except ValidationError as error:
            problems.add_errors(given.origin, error, LEAVES[name].field.annotation)
            return given
        return replace(given, value=value, identity=identity(value))

    _change(declaration, typed)
    for row in declaration.exclude:
        row.values = {name: [typed(name, given) for given in leaf_values] for name, leaf_values in row.values.items()}


def check_backends(declaration: Declaration, backends: Collection[str], problems: FileProblems) -> None:
    """Report backends that there are not; no rule looks at them after that.

    A row of `exclude` may name one all the same: of another installation.
    """

    def known(name: str, given: LeafValue) -> LeafValue:
        if name != "backend" or given.origin is None or given.identity is None or given.value in backends:
            return given
        hint = near(given.value, backends) or f"; there are {listed(sorted(backends))}"
        problems.add(given.origin, f"unknown backend {shown(given.value)}{hint}")
        return replace(given, identity=None)

    _change(declaration, known)


def _change(declaration: Declaration, changed: Callable[[str, LeafValue], LeafValue]) -> None:
    """Put others in the place of the values of all points."""
    declaration.base = {name: changed(name, given) for name, given in declaration.base.items()}
    for axis in declaration.axes:
        axis.rows = [tuple(map(changed, axis.leaves, row)) for row in axis.rows]
    declaration.include = [
        {name: changed(name, given) for name, given in included.items()} for included in declaration.include
    ]


def _read_block(declaration: Declaration, columns: Any, path: KeyPath, problems: FileProblems) -> None:
    lists = {
        name: values for name, values in _leaves(columns, path, problems) if _is_values(values, (*path, name), problems)
    }
    for name in list(lists):
        if declaration.axis_of(name) is not None:
            problems.add((*path, name, KEY), f"{name} varies already; a leaf can vary in one place only")
            del lists[name]
    lengths = {name: len(values) for name, values in lists.items()}
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        problems.add(path, f"lists that vary together must be of equal length; {counts}")
    elif lists:
        count = next(iter(lengths.values()))
        rows = [tuple(LeafValue(lists[name][row], (*path, name, row)) for name in lists) for row in range(count)]
        declaration.axes.append(Axis(tuple(lists), rows))


def _remove(declaration: Declaration, name: str) -> None:
    """Take a leaf out of everything that gives it."""
    for values in (declaration.base, *declaration.include):
        values.pop(name, None)
    for axis in declaration.axes:
        if name in axis.leaves:
            column = axis.leaves.index(name)
            axis.leaves = (*axis.leaves[:column], *axis.leaves[column + 1 :])
            axis.rows = [(*row[:column], *row[column + 1 :]) for row in axis.rows]
    declaration.axes = [axis for axis in declaration.axes if axis.leaves]


def _leaves(value: Any, path: KeyPath, problems: FileProblems) -> Iterator[tuple[str, Any]]:
    """The known leaves of a mapping; the others are reported."""
    for name, item in _mapping(value, path, problems).items():
        if name in LEAVES:
            yield name, item
        else:
            problems.add((*path, name, KEY), unknown_leaf(name))


def _mapping(value: Any, path: KeyPath, problems: FileProblems) -> Mapping[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        problems.add(path, f"must be a mapping of keys to values, not {shown(value)}")
        return {}
    return value


def _list(value: Any, path: KeyPath, problems: FileProblems) -> list[Any]:
    if value is None:
        return []
    if not isinstance(value, list):
        problems.add(path, f"must be a list of rows, such as [{{count: 5}}], not {shown(value)}")
        return []
    return value


def _is_values(value: Any, path: KeyPath, problems: FileProblems) -> bool:
    """Whether this is a list of values for a leaf; it is reported if not."""
    if not isinstance(value, list):
        problems.add(path, f"must be a list of values, not {shown(value)}")
    elif not value:
        problems.add(path, "needs at least one value")
    return isinstance(value, list) and bool(value)


def _any_of(name: str, value: Any, path: KeyPath) -> list[LeafValue]:
    if LEAVES[name].holds_many(value):
        return [LeafValue(item, (*path, place)) for place, item in enumerate(value)]
    return [LeafValue(value, path)]
