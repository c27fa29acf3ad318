"""Leaves: the single values of scene, motion and engine, addressed by name alone wherever values vary."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, TypeAdapter
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from harness.experiment.messages import near, shown
from harness.experiment.number import wrong
from harness.experiment.schema import EngineSpec, MeasureSpec, MotionSpec, SceneSpec

SECTIONS: dict[str, type[BaseModel]] = {"scene": SceneSpec, "motion": MotionSpec, "engine": EngineSpec}
# Parameters derived from a point's leaves and its mesh: they select results as leaves do, and cannot be set.
DERIVED = ("faces", "hull_vertices", "packing", "box_side")
# Giving one of these in a sweep or with --set takes the place of the other.
INSTEAD_OF = {"count": "bodies", "bodies": "count", "box": "box_ratio", "box_ratio": "box"}
NUMERIC = {
    "count",
    "size",
    "box_ratio",
    "speed",
    "spin",
    "seed",
    "duration",
    "dt",
    "restitution",
    "within",
    "tolerance",
    "threads",
    *DERIVED,
}


@dataclass(frozen=True)
class Leaf:
    """One leaf: its name, the section it belongs to, and the model that holds the section."""

    name: str
    section: str
    model: type[BaseModel]

    @property
    def field(self) -> FieldInfo:
        """As the model declares it."""
        return self.model.model_fields[self.name]

    @property
    def is_list(self) -> bool:
        """Whether one value of it is a list already."""
        return self.name in ("box", "bodies", "ignore")

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        annotation: Any = Annotated[self.field.annotation, self.field]
        return TypeAdapter(annotation)

    def check(self, value: Any) -> Any:
        """The value in its type.

        Raises
        ------
        pydantic.ValidationError
            If it is no value for this leaf.
        """
        return self._adapter.validate_python(value)

    def holds_many(self, value: Any) -> bool:
        """Whether a list is one of several values, not one value."""
        if not isinstance(value, list | tuple):
            return False
        if self.name == "ignore":  # one value is a list of pairs
            return any(
                isinstance(pair, list | tuple) for item in value if isinstance(item, list | tuple) for pair in item
            )
        return not self.is_list or any(isinstance(item, list | tuple) for item in value)

    @property
    def default(self) -> Any:
        """The value where none is given."""
        return self.field.default


LEAVES: dict[str, Leaf] = {
    name: Leaf(name, section, model) for section, model in SECTIONS.items() for name in model.model_fields
}


def identity(value: Any) -> str:
    """The same text for the same value of a leaf.

    >>> identity({"uniform": [0.5, 1.5]}) == identity({"uniform": (0.5, 1.5)})
    True
    """
    return json.dumps(plain(value), sort_keys=True)


def plain(value: Any) -> Any:
    """A leaf's value as JSON holds it, which is as YAML does."""
    return to_jsonable_python(value)


def mesh_names_in(leaf: str, value: Any) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """The meshes that a value of a leaf names, as JSON holds it, each with the keys that lead to it.

    >>> list(mesh_names_in("mesh", {"choice": ["a.ply", "b.ply"]}))
    [(('choice', 0), 'a.ply'), (('choice', 1), 'b.ply')]
    """
    if leaf == "mesh" and isinstance(value, dict):
        yield from ((("choice", place), name) for place, name in enumerate(value["choice"]))
    elif leaf == "mesh" and value is not None:
        yield (), value
    elif leaf == "bodies":
        for place, body in enumerate(value or ()):
            if body["mesh"] is not None:
                yield (place, "mesh"), body["mesh"]


def unknown_key(name: str, options: Iterable[str]) -> str:
    """What to say about a key that is not one of `options`, the keys of its section."""
    sections = {leaf.name: leaf.section for leaf in LEAVES.values()} | dict.fromkeys(
        MeasureSpec.model_fields, "measure"
    )
    hint = f"; it belongs under {sections[name]}" if name in sections else near(name, options)
    return f"unknown key {shown(name)}{hint}"


def unknown_leaf(name: str) -> str:
    """What to say about a name that is no leaf."""
    if name in MeasureSpec.model_fields:
        return f"{shown(name)} belongs to measure and cannot vary"
    if name in DERIVED:
        return f"{shown(name)} follows from the scene and cannot be set"
    return f"unknown leaf {shown(name)}{near(name, LEAVES)}"


def _known(name: str) -> str:
    if name not in LEAVES and name not in DERIVED:
        raise wrong(f"unknown leaf {shown(name)}{near(name, (*LEAVES, *DERIVED))}")
    return name


def _numeric(name: str) -> str:
    if _known(name) not in NUMERIC:
        raise wrong(f"{name} is not a number that anything could grow with")
    return name


# The name of a leaf or of a derived parameter, and of one that is a number.
LeafName = Annotated[str, AfterValidator(_known)]
NumericLeafName = Annotated[str, AfterValidator(_numeric)]
