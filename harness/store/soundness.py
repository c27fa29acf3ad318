"""Whether a results file holds what the program writes: SQLite itself only knows whether its pages are whole."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from functools import cache

# Columns of JSON objects, by their tables.
_OBJECTS = {
    "machine": ("facts",),
    "sweep": ("packages",),
    "experiment": ("specification",),
    "point": ("parameters", "plan"),
    "run": ("conditions",),
    "control": ("metrics",),
    "recording": ("facts",),
    "expectation": ("criterion", "detail"),
    "claim": ("criterion", "detail"),
    "comparison": ("document",),
}
# What such an object holds, where it holds it: the types of JSON, as SQLite names them.
_NUMBER = ("integer", "real")
_INSIDE: dict[tuple[str, str], dict[str, tuple[str, ...]]] = {
    ("experiment", "specification"): {
        "expect": ("array",),
        "claims": ("array",),
        "swept": ("array",),
        "measure": ("object",),
        "published": ("object", "null"),
        "report": ("object", "null"),
    },
    ("point", "plan"): {"stages": ("array",), "warnings": ("array",)},
    ("recording", "facts"): {
        "shape": ("text",),
        "duration": _NUMBER,
        "dt": (*_NUMBER, "null"),
        "half_box": ("array", "null"),
    },
}
# And what all elements of a list of it are, or all of its values.
_ELEMENTS: dict[tuple[str, str, str], tuple[str, ...]] = {
    ("run", "conditions", "$"): (*_NUMBER, "null"),
    ("control", "metrics", "$"): (*_NUMBER, "null"),
    ("experiment", "specification", "$.expect"): ("object",),
    ("experiment", "specification", "$.claims"): ("object",),
    ("experiment", "specification", "$.swept"): ("text",),
    ("point", "plan", "$.stages"): ("object",),
    ("point", "plan", "$.warnings"): ("text",),
}
# And what each of the objects of a list says.
_KEYS = {
    ("experiment", "specification", "$.expect"): "metric",
    ("experiment", "specification", "$.claims"): "metric",
    ("point", "plan", "$.stages"): "kept",
}
_NUMBERS = {"run": "repeat", "control": "repeat"}


def damage(connection: sqlite3.Connection, tables: str) -> str | None:
    """What is wrong first with the rows of a results file; None if nothing is.

    Parameters
    ----------
    connection : that can read it
    tables : SQL of the tables as the program makes them
    """
    return next(_damages(connection, tables), None)


def _damages(connection: sqlite3.Connection, tables: str) -> Iterator[str]:
    held = _columns(connection)
    for name, columns in _columns_made(tables).items():
        if lacking := columns - held.get(name, set()):
            yield f"{name} lacks {', '.join(sorted(lacking))}"
    for table, columns_of_json in _OBJECTS.items():
        for column in columns_of_json:
            # the case keeps json_type from what is no JSON, which it would raise an error for
            object_or_not = f"CASE WHEN json_valid({column}) THEN json_type({column}) END"
            if _any(connection, table, f"{object_or_not} IS NOT 'object'"):
                yield f"{table}.{column} is no JSON object"
    for (table, column), held_inside in _INSIDE.items():
        for key, types in held_inside.items():
            if _any(connection, table, f"json_type({column}, '$.{key}') NOT IN ({_listed(types)})"):
                yield f"{table}.{column} has no {key} as it must be"
    for (table, column, place), types in _ELEMENTS.items():
        if _any(
            connection, f"{table}, json_each({table}.{column}, '{place}') AS one", f"one.type NOT IN ({_listed(types)})"
        ):
            yield f"{table}.{column} has a value of another kind{'' if place == '$' else f' in {place[2:]}'}"
    for (table, column, place), key in _KEYS.items():
        if _any(
            connection,
            f"{table}, json_each({table}.{column}, '{place}') AS one",
            f"json_type(one.value, '$.{key}') IS NULL",
        ):
            yield f"{table}.{column} has no {key} in {place[2:]}"
    found = "json_type(document, '$.pairs') IS NOT 'array' AND json_type(document, '$.truth') IS NOT 'object'"
    if _any(connection, "comparison", found):
        yield "comparison.document tells neither of pairs of backends nor of cases"
    for table, column in _NUMBERS.items():
        if _any(connection, table, f"typeof({column}) <> 'integer'"):
            yield f"{table}.{column} is no number"
    if _any(connection, "metric", "typeof(value) NOT IN ('real', 'integer', 'null')"):
        yield "metric.value is no number"
    for table, _, other, _ in connection.execute("PRAGMA foreign_key_check"):
        yield f"a row of {table} refers to a row of {other} that is not there"


@cache
def _columns_made(tables: str) -> dict[str, set[str]]:
    """The columns of each table and view that SQL makes."""
    with closing(sqlite3.connect(":memory:")) as made:
        made.executescript(tables)
        return _columns(made)


def _columns(connection: sqlite3.Connection) -> dict[str, set[str]]:
    """The columns of each table and view."""
    names = connection.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')").fetchall()
    return {
        name: {column for (column,) in connection.execute("SELECT name FROM pragma_table_info(?)", (name,))}
        for (name,) in names
    }


def _listed(types: tuple[str, ...]) -> str:
    return ", ".join(f"'{name}'" for name in types)


def _any(connection: sqlite3.Connection, table: str, condition: str) -> bool:
    (found,) = connection.execute(f"SELECT EXISTS (SELECT * FROM {table} WHERE {condition})").fetchone()
    return bool(found)
