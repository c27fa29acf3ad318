"""What a file declares to run: values of the base point, axes that vary, and rows that take points out or add some."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from harness.experiment.complaints import Complaints, Origin, Override
from harness.experiment.document import KEY, KeyPath
from harness.experiment.leaves import INSTEAD_OF, LEAVES, SECTIONS, identity, unknown_key, unknown_leaf
from harness.experiment.messages import shown


@dataclass(frozen=True)
class Given:
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
    rows: list[tuple[Given, ...]]


@dataclass
class ExcludeRow:
    """Points with one of these values for each of these leaves are taken out."""

    path: KeyPath
    values: dict[str, list[Given]]


@dataclass
class Declaration:
    """`narrowed`: leaves were set from outside, so that rows of the file may have lost what they were about."""

    base: dict[str, Given] = field(default_factory=dict)
    axes: list[Axis] = field(default_factory=list)
    exclude: list[ExcludeRow] = field(default_factory=list)
    include: list[dict[str, Given]] = field(default_factory=list)
    narrowed: bool = False

    def axis_of(self, leaf: str) -> Axis | None:
        """The axis that a leaf varies along."""
        return next((axis for axis in self.axes if leaf in axis.leaves), None)


def declare(file: Mapping[str, Any], complaints: Complaints) -> Declaration:
    """Read the sections of a file that say what to run. Names are checked, values are not yet: see `check`."""
    declaration = Declaration()
    for section, model in SECTIONS.items():
        for name, value in _mapping(file.get(section), (section,), complaints).items():
            if name in model.model_fields:
                declaration.base[name] = Given(value, (section, name))
            else:
                complaints.add((section, name, KEY), unknown_key(name, model.model_fields))
    for name, values in _leaves(file.get("sweep"), ("sweep",), complaints):
        if _is_values(values, ("sweep", name), complaints):
            givens = [Given(value, ("sweep", name, place)) for place, value in enumerate(values)]
            declaration.axes.append(Axis((name,), [(given,) for given in givens]))
    for block, columns in enumerate(_list(file.get("zip"), ("zip",), complaints)):
        _read_block(declaration, columns, ("zip", block), complaints)
    for place, row in enumerate(_list(file.get("exclude"), ("exclude",), complaints)):
        path: KeyPath = ("exclude", place)
        values = {name: _any_of(name, value, (*path, name)) for name, value in _leaves(row, path, complaints)}
        if not values and isinstance(row, dict | None) and not row:
            complaints.add(path, "an empty row would exclude every point")
        declaration.exclude.append(ExcludeRow(path, values))
    for place, row in enumerate(_list(file.get("include"), ("include",), complaints)):
        path = ("include", place)
        leaves = dict(_leaves(row, path, complaints))
        if isinstance(row, dict) and len(leaves) == len(row):
            declaration.include.append({name: Given(value, (*path, name)) for name, value in leaves.items()})
    return declaration


def override(declaration: Declaration, setting: Override, value: Any, complaints: Complaints) -> None:
    """Set a leaf from outside: in the base, in place of its list where it varies, and in the rows of `include`."""
    name = setting.leaf
    many = LEAVES[name].holds_many(value)
    givens = [Given(item, setting) for item in (value if many else [value])]
    if not givens:
        complaints.add(setting, "needs at least one value")
        return
    declaration.narrowed = True
    if name in INSTEAD_OF:
        _forget(declaration, INSTEAD_OF[name])
    axis = declaration.axis_of(name)
    if axis is not None and len(axis.leaves) > 1:
        if len(givens) not in (1, len(axis.rows)):
            others = len(axis.rows)
            complaints.add(setting, f"needs 1 or {others} values, for it varies together with other leaves")
            return
        column = axis.leaves.index(name)
        new = givens if len(givens) > 1 else givens * len(axis.rows)
        rows = zip(axis.rows, new, strict=True)
        axis.rows = [(*row[:column], given, *row[column + 1 :]) for row, given in rows]
    elif axis is not None:
        axis.rows = [(given,) for given in givens]
    elif many:
        declaration.axes.append(Axis((name,), [(given,) for given in givens]))
    if not many:
        declaration.base[name] = givens[0]
        for row in declaration.include:
            if name in row:
                row[name] = givens[0]


def check(declaration: Declaration, complaints: Complaints) -> None:
    """Turn every value into its leaf's type, and complain of those that are none."""

    def typed(name: str, given: Given) -> Given:
        if given.origin is None:
            return given
        try:
            value = LEAVES[name].check(given.value)
        except ValidationError as error:
            complaints.add_errors(given.origin, error, LEAVES[name].field.annotation)
            return given
        return replace(given, value=value, identity=identity(value))

    declaration.base = {name: typed(name, given) for name, given in declaration.base.items()}
    for axis in declaration.axes:
        axis.rows = [tuple(map(typed, axis.leaves, row)) for row in axis.rows]
    for row in declaration.exclude:
        row.values = {name: [typed(name, given) for given in givens] for name, givens in row.values.items()}
    declaration.include = [
        {name: typed(name, given) for name, given in included.items()} for included in declaration.include
    ]


def _read_block(declaration: Declaration, columns: Any, path: KeyPath, complaints: Complaints) -> None:
    lists = {
        name: values
        for name, values in _leaves(columns, path, complaints)
        if _is_values(values, (*path, name), complaints)
    }
    for name in list(lists):
        if declaration.axis_of(name) is not None:
            complaints.add((*path, name, KEY), f"{name} varies already; a leaf can vary in one place only")
            del lists[name]
    lengths = {name: len(values) for name, values in lists.items()}
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        complaints.add(path, f"lists that vary together must be of equal length; {counts}")
    elif lists:
        count = next(iter(lengths.values()))
        rows = [tuple(Given(lists[name][row], (*path, name, row)) for name in lists) for row in range(count)]
        declaration.axes.append(Axis(tuple(lists), rows))


def _forget(declaration: Declaration, name: str) -> None:
    """Take a leaf out of everything that gives it."""
    for given in (declaration.base, *declaration.include):
        given.pop(name, None)
    for axis in declaration.axes:
        if name in axis.leaves:
            column = axis.leaves.index(name)
            axis.leaves = (*axis.leaves[:column], *axis.leaves[column + 1 :])
            axis.rows = [(*row[:column], *row[column + 1 :]) for row in axis.rows]
    declaration.axes = [axis for axis in declaration.axes if axis.leaves]


def _leaves(value: Any, path: KeyPath, complaints: Complaints) -> Iterator[tuple[str, Any]]:
    """The known leaves of a mapping; the others are complained of."""
    for name, item in _mapping(value, path, complaints).items():
        if name in LEAVES:
            yield name, item
        else:
            complaints.add((*path, name, KEY), unknown_leaf(name))


def _mapping(value: Any, path: KeyPath, complaints: Complaints) -> Mapping[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        complaints.add(path, f"must be a mapping of keys to values, not {shown(value)}")
        return {}
    return value


def _list(value: Any, path: KeyPath, complaints: Complaints) -> list[Any]:
    if value is None:
        return []
    if not isinstance(value, list):
        complaints.add(path, f"must be a list of rows, such as [{{count: 5}}], not {shown(value)}")
        return []
    return value


def _is_values(value: Any, path: KeyPath, complaints: Complaints) -> bool:
    """Whether this is a list of values for a leaf; complained of if not."""
    if not isinstance(value, list):
        complaints.add(path, f"must be a list of values, not {shown(value)}")
    elif not value:
        complaints.add(path, "needs at least one value")
    return isinstance(value, list) and bool(value)


def _any_of(name: str, value: Any, path: KeyPath) -> list[Given]:
    if LEAVES[name].holds_many(value):
        return [Given(item, (*path, place)) for place, item in enumerate(value)]
    return [Given(value, path)]
