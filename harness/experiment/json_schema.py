"""The JSON Schema of an experiment file, by which editors complete and check it.

It takes every file that loads and no unknown key. It is made for files as editors read them: by YAML 1.2, to which
`1/60`, `1_000` and `on` are text.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from harness.experiment.criterion import Criterion
from harness.experiment.leaves import DERIVED, LEAVES, NUMERIC, SECTIONS
from harness.experiment.presentation import Published, ReportSpec
from harness.experiment.scalar import DECIMAL
from harness.experiment.schema import MeasureSpec

DIALECT = "https://json-schema.org/draft/2020-12/schema"
NUMBER_TEXT = rf"^\s*[-+]?{DECIMAL}([eE][-+]?[0-9]+|\s*/\s*{DECIMAL})?\s*$"
SWITCH_TEXT = ["on", "off", "On", "Off", "ON", "OFF", "yes", "no", "Yes", "No", "YES", "NO"]

# pydantic's names of bounds, which it leaves as they are behind a validator of ours, and JSON Schema's.
_BOUNDS = {"ge": "minimum", "gt": "exclusiveMinimum", "le": "maximum", "lt": "exclusiveMaximum"}

Schema = dict[str, Any]


def json_schema() -> Schema:
    """The schema of a whole file, as JSON holds it."""
    models: list[type[BaseModel]] = [*SECTIONS.values(), MeasureSpec, Criterion, Published, ReportSpec]
    _, made = models_json_schema([(model, "validation") for model in models], ref_template="#/$defs/{model}")
    definitions = {name: _as_editors_read(definition) for name, definition in made["$defs"].items()}
    definitions["NumberAsText"] = {"type": "string", "pattern": NUMBER_TEXT}
    definitions |= {_leaf_name(name): _leaf(definitions, name) for name in LEAVES}
    leaves = {name: {"$ref": f"#/$defs/{_leaf_name(name)}"} for name in LEAVES}
    for name in (model.__name__ for model in SECTIONS.values()):
        definitions[name].pop("required", None)  # a sweep may give what the section leaves out
    _name_leaves(definitions, leaves)
    sections = {section: _or_nothing(_ref(model)) for section, model in SECTIONS.items()}
    return {
        "$schema": DIALECT,
        "title": "An experiment",
        "type": "object",
        "additionalProperties": False,
        "required": ["title"],
        "properties": {
            "title": {"type": "string", "minLength": 1, "description": "what the experiment is about"},
            "question": {"type": ["string", "null"], "minLength": 1, "description": "what it is to answer"},
            **sections,
            "sweep": _each(leaves, _many, "leaf: [values]; every combination of these lists is a point"),
            "zip": _rows(_each(leaves, _many, "lists of equal length that vary together")),
            "exclude": _rows(_each(leaves, _one_or_many, "points with these values are left out")),
            "include": _rows(_each(leaves, dict, "a whole point, over the values of the sections")),
            "measure": _or_nothing(_ref(MeasureSpec)),
            "expect": _rows(_ref(Criterion), "must hold, else the sweep fails"),
            "claims": _rows(_ref(Criterion), "hypotheses; the report says which of them hold"),
            "published": _or_nothing(_ref(Published)),
            "report": _or_nothing(_ref(ReportSpec)),
        },
        "$defs": definitions,
    }


def _ref(model: type[BaseModel]) -> Schema:
    return {"$ref": f"#/$defs/{model.__name__}"}


def _or_nothing(schema: Schema) -> Schema:
    """An empty section is nothing to a reader of YAML."""
    return {"anyOf": [schema, {"type": "null"}]}


def _leaf_name(name: str) -> str:
    return f"leaf-{name}"


def _leaf(definitions: Mapping[str, Schema], name: str) -> Schema:
    """A value of a leaf, wherever it is given."""
    properties = definitions[LEAVES[name].model.__name__]["properties"]
    return {key: value for key, value in properties[name].items() if key not in ("default", "title")}


def _many(leaf: Schema) -> Schema:
    return {"type": "array", "minItems": 1, "items": leaf}


def _one_or_many(leaf: Schema) -> Schema:
    return {"anyOf": [leaf, _many(leaf)]}


def _each(leaves: Mapping[str, Schema], form: Any, description: str) -> Schema:
    properties = {name: form(leaf) for name, leaf in leaves.items()}
    return {
        "type": ["object", "null"],
        "description": description,
        "additionalProperties": False,
        "properties": properties,
    }


def _rows(schema: Schema, description: str = "") -> Schema:
    return {"type": ["array", "null"], "items": schema} | ({"description": description} if description else {})


def _name_leaves(definitions: Mapping[str, Schema], leaves: Mapping[str, Schema]) -> None:
    """Say which names can stand where pydantic only knows that a function will check them."""
    derived = {name: _as_editors_read({"type": "number"}) for name in DERIVED}
    where = {"type": "object", "additionalProperties": False, "properties": {**leaves, **derived}}
    criterion = definitions["Criterion"]["properties"]
    criterion["where"] = {**where, "description": criterion["where"]["description"]}
    criterion["ratio_to"] = {
        **where,
        "type": ["object", "null"],
        "description": criterion["ratio_to"]["description"],
    }
    report = definitions["ReportSpec"]["properties"]
    for properties, name, options in ((criterion, "exponent_of", sorted(NUMERIC)), (report, "x", [*LEAVES, *DERIVED])):
        properties[name] = {"enum": [*options, None], "description": properties[name]["description"]}
    y = report["y"]
    metrics = {key: value for key, value in y.items() if key not in ("default", "description", "title")}
    report["y"] = {
        "anyOf": [{"type": "string", "minLength": 1}, metrics],
        "description": y["description"],
    }


def _as_editors_read(schema: Any) -> Any:
    """The schema, with numbers and switches also as the text that YAML 1.2 takes some of them for."""
    if isinstance(schema, list):
        return [_as_editors_read(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    outside = {key: schema[key] for key in ("default", "description") if key in schema}
    if schema.get("type") in ("number", "integer"):
        inside = {key: value for key, value in schema.items() if key not in ("default", "description", "title")}
        number = {_BOUNDS.get(key, key): value for key, value in inside.items()}
        return {"anyOf": [number, {"$ref": "#/$defs/NumberAsText"}], **outside}
    if schema.get("type") == "boolean":
        return {"anyOf": [{"type": "boolean"}, {"enum": SWITCH_TEXT}], **outside}
    kept = {key: _as_editors_read(value) for key, value in schema.items() if not _is_heading(key, value)}
    items = kept.get("prefixItems")
    if items and all(item == items[0] for item in items):
        kept["items"] = kept.pop("prefixItems")[0]  # older editors know no prefixItems
    return kept


def _is_heading(key: str, value: Any) -> bool:
    """pydantic's headings repeat the names; a property that is called title is a mapping."""
    return key == "title" and isinstance(value, str)
