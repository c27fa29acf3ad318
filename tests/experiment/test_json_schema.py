"""The schema for editors takes what loads, and refuses what does not."""

import json
from collections.abc import Callable
from typing import Any

import jsonschema
import pytest
import yaml

from harness.experiment.experiment import Experiment
from harness.experiment.json_schema import json_schema
from harness.experiment.load import KEYS

Read = Callable[..., Experiment]

SCHEMA = json_schema()
CHECKER = jsonschema.Draft202012Validator(SCHEMA)

FULL = """
title: Everything
question: null
scene:
  mesh: cube.ply
  shape: hull
  size: {choice: [1/2, 1e-1]}
  box_ratio: 1/100
  speed: {uniform: [0, 1_0]}
  count: 1e2
motion: {duration: 10, dt: 1/60, response: elastic, restitution: 1/2}
engine: {stages: {hull_axis: off, walls: yes}, tolerance: 1e-6}
sweep: {count: [5, 10], box: [[1, 2, 3/2]], seed: [1, 2]}
zip: [{dt: [1/60, 1/30], shape: [hull, mesh]}]
exclude: [{count: 5, seed: [1, 2], shape: hull}]
include: [{bodies: [{position: [0, 0, 1/3], mass: 2}], box_ratio: 1/4}]
measure: {repeats: 5, memory: 512 MiB, tier: long, reference: {algorithm: predictive, tolerance: 1e-10}}
expect:
  - {metric: energy_drift, at_most: 1.0e-12, where: {count: 5, faces: 1753}}
  - {metric: escaped, within: {of: 0, relative: 1/100}, source: us}
claims:
  - {metric: pair_seconds, exponent_of: faces, between: [1.8, 2.2]}
  - {metric: pair_seconds, ratio_to: {algorithm: grid}, at_most: 1/2}
published: {source: s, note: n, rows: [{count: 5, fps: 1/3, mesh: cube.ply}]}
report: {x: faces, y: pair_seconds}
"""


def as_an_editor_reads(text: str) -> Any:
    """YAML 1.2's core schema, in which fractions, 1_000 and on are text; close enough: PyYAML without booleans."""

    class Loader(yaml.SafeLoader):
        pass

    Loader.yaml_implicit_resolvers = {
        first: [(tag, pattern) for tag, pattern in pairs if "bool" not in tag]
        for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }
    return yaml.load(text, Loader)


def test_the_schema_is_one(read: Read) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert list(SCHEMA["properties"]) == list(KEYS)


def test_a_file_with_every_section_loads_and_is_taken(read: Read) -> None:
    assert read(FULL).points
    assert list(CHECKER.iter_errors(as_an_editor_reads(FULL))) == []


def test_empty_sections_are_taken() -> None:
    assert CHECKER.is_valid({"title": "t", **dict.fromkeys(KEYS[1:])})


@pytest.mark.parametrize(
    "change",
    [
        ("question", "qestion"),
        ("count: 1e2", "cuont: 1e2"),
        ("dt: 1/60, resp", "dt: 1/x, resp"),
        ("shape: hull\n", "shape: hul\n"),
        ("tier: long", "tier: short"),
        ("512 MiB", "512 MiX"),
        ("hull_axis: off", "hull_axis: of"),
        ("repeats: 5", "repeats: 0"),
        ("exponent_of: faces", "exponent_of: shape"),
        ("{count: 5, faces", "{cuont: 5, faces"),
        ("x: faces", "x: fases"),
        ("sweep: {count", "sweep: {cuont"),
        ("{uniform: [0, 1_0]}", "{uniform: [0]}"),
        ("position", "positon"),
        ("mass: 2", "mass: -2"),
        ("[[1, 2, 3/2]]", "[[1, 2]]"),
        ("title: Everything", ""),
        ("relative:", "relativ:"),
    ],
    ids=str,
)
def test_what_is_misspelt_or_out_of_range_is_refused(change: tuple[str, str]) -> None:
    assert change[0] in FULL
    assert not CHECKER.is_valid(as_an_editor_reads(FULL.replace(*change)))


def test_every_leaf_says_what_it_is() -> None:
    for name, definition in SCHEMA["$defs"].items():
        if name.endswith("Spec") or name.startswith("leaf-"):
            for inner in definition.get("properties", {name: definition}).values():
                assert inner["description"], name
