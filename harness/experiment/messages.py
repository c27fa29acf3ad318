"""Messages for people: values as they would write them, near misses, and pydantic's errors as plain sentences."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, get_args

if TYPE_CHECKING:  # of a library whose import takes longer than most commands that print a message
    from pydantic import BaseModel

_LONGEST = 60
_PLAIN = re.compile(r"[A-Za-z_][\w./:+-]*")


def shown(value: Any) -> str:
    """A value in a sentence: text in quotes and never long, collections by their kind.

    >>> shown("grid"), shown(2.0), shown(True), shown([1, 2]), shown(None)
    ('"grid"', '2', 'true', 'a list', 'nothing')
    """
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + printable(value) + '"'
    if isinstance(value, int | float):
        return printable(_number(value))
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    return f"a {type(value).__name__}"


def printable(text: str) -> str:
    """Text on one line, cut where it is long, without characters that a terminal would obey."""
    cut = text[:_LONGEST] + "…" if len(text) > _LONGEST else text
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in cut)


def flow(value: Any) -> str:
    """A JSON-like value as a user would write it in a line of YAML.

    >>> flow({"count": [5, 10], "stages": {"crossing": False}})
    '{count: [5, 10], stages: {crossing: off}}'
    """
    if isinstance(value, bool):
        return "on" if value else "off"
    if value is None:
        return "null"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{flow(key)}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, str):
        return value if _PLAIN.fullmatch(value) and len(value) <= _LONGEST else shown(value)
    return _number(value)


def listed(words: Iterable[str], last: str = "and") -> str:
    """Words in a row.

    >>> listed(["a", "b", "c"]), listed(["a", "b"], "or"), listed(["a"])
    ('a, b and c', 'a or b', 'a')
    """
    *most, final = words
    return f"{', '.join(most)} {last} {final}" if most else final


def near(name: str, options: Iterable[str]) -> str:
    """A hint at the option that a name nearly is, else nothing.

    >>> near("cuont", ["count", "size"]), near("mass", ["count", "size"])
    ('; did you mean "count"?', '')
    """
    if len(name) > _LONGEST:
        return ""
    by_folded = {option.casefold(): option for option in options}
    close = difflib.get_close_matches(name.casefold(), by_folded, n=1, cutoff=0.6)
    return f'; did you mean "{printable(by_folded[close[0]])}"?' if close else ""


def sentence(error: Mapping[str, Any], model: Any) -> str:
    """One of pydantic's error dictionaries as a sentence about the value it is about.

    Parameters
    ----------
    error : from `ValidationError.errors()`
    model : the type that was asked for, to name the keys it has
    """
    kind, context, value = error["type"], error.get("ctx", {}), error["input"]
    if kind == "extra_forbidden":
        name, options = str(error["loc"][-1]), _keys_at(model, error["loc"])
        there = f"; there is only {options[0]}" if len(options) == 1 else f"; there are {listed(options)}"
        return f"unknown key {shown(name)}{near(name, options) or there}"
    if kind == "missing":
        return f'"{error["loc"][-1]}" is missing'
    if kind == "literal_error":
        options = re.findall(r"'([^']*)'", context["expected"])
        hint = near(value, options) if isinstance(value, str) else ""
        return f"must be {listed(options, 'or')}, not {shown(value)}{hint}"
    if kind in _BOUNDS:
        words, name = _BOUNDS[kind]
        return f"must be {words} {shown(context[name])}, not {shown(value)}"
    if kind in _KINDS:
        return f"must be {_KINDS[kind]}, not {shown(value)}"
    if kind == "string_type":
        quotes = "" if value is None or isinstance(value, dict | list) else "; put it in quotes if text is meant"
        return f"must be text, not {shown(value)}{quotes}"
    if kind in ("too_short", "string_too_short"):
        return "must not be empty"
    if kind == "too_long":
        return f"must hold at most {context['max_length']} values"
    return str(error["msg"])


_BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_KINDS = {
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a mapping of keys to values",
    "model_type": "a mapping of keys to values",
    "model_attributes_type": "a mapping of keys to values",
    "bool_type": "on or off",
}


def _number(value: float) -> str:
    try:
        text = repr(value)
    except ValueError:  # an integer too long for Python to print
        return "a number of thousands of digits"
    return text.removesuffix(".0") if "e" not in text else text


def _keys_at(model: Any, location: tuple[str | int, ...]) -> list[str]:
    """The keys that the innermost model along an error's location has."""
    models = _models_in(model)
    for step in location[:-1]:
        for one in models:
            if step in one.model_fields:
                models = _models_in(one.model_fields[str(step)].annotation) or [one]
                break
    return [name for one in models for name in one.model_fields]


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    """The models that a type is made of; a root model stands for what it holds."""
    from pydantic import BaseModel, RootModel

    if isinstance(annotation, type) and issubclass(annotation, RootModel):
        return _models_in(annotation.model_fields["root"].annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for inner in get_args(annotation) for found in _models_in(inner)]
