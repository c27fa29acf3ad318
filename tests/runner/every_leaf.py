"""Each number of an experiment file takes each extreme in turn: an answer or a refusal that a person understands.

    python tests/runner/every_leaf.py [LEAF ...]

The files of `EXPERIMENTS` give a number for every leaf that takes one. A value goes through `validate`, `plan` and a
run under limits, those of expectations and claims through their verdict as well. Where `extreme_numbers.py` changes
many numbers at random, this leaves the others as they are, so that no leaf hides behind another's refusal. Prints what
came of each leaf, and every file that was not right.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from harness.errors import InputError
from harness.experiment.load import load_text
from harness.measure.verdicts import verdict_on
from harness.runner.point import plan_of
from harness.runner.scene_of_point import build_scene
from harness.runner.servers import Servers, files_of
from harness.runner.sweep import run
from harness.scene.mesh import Mesh
from tests.runner.extreme_numbers import NUMBERS, meshes, outcome

# Of another sort than `NUMBERS`: wrong signs, beyond what is legal or what a float holds, and what is no number.
ODD = (
    -1,
    -1e-30,
    1e-31,
    1e-320,
    1e31,
    1e300,
    -1e300,
    10**400,
    0.1 + 0.2,
    2**31,
    2**63,
    float("nan"),
    float("inf"),
    True,
    "1e3",
    "",
    [],
)
VALUES = (*(number for number in NUMBERS if number), *ODD)
LIMITS = ("timeout", "memory")
CRITERIA = ("expect", "claims")

EXPERIMENTS = """
spheres:
  title: Spheres
  scene: {shape: sphere, count: 8, size: {uniform: [0.5, 1.5]}, box: [5, 5, 5], speed: 1, spin: 1, seed: 259}
  motion: {duration: 0.5, dt: 0.02, response: elastic, restitution: 0.5}
  engine: {algorithm: predictive, tolerance: 1.0e-6}
  measure: {repeats: 1, timeout: 20, memory: 1000000000, max_runs: 10, reference: {tolerance: 1.0e-10}}
  expect:
  - {metric: frames, at_most: 1}
  - {metric: frames, at_least: 1}
  - {metric: frames, equals: 25, where: {count: 8}}
  - {metric: frames, between: [1, 100]}
  - {metric: frames, within: {of: 25, relative: 0.1}}
  - {metric: frames, ratio_to: {count: 8, size: 1, dt: 0.02, tolerance: 1.0e-6}, at_most: 1}
  claims:
  - {metric: pair_tests, exponent_of: count, between: [1.8, 2.2]}
  published:
    source: a page
    rows: [{count: 8, frames_per_second: 85.1}]
hulls:
  title: Hulls
  scene: {mesh: cube.ply, shape: hull, count: 8, size: {choice: [0.5, 1]}, box_ratio: 0.05, speed: {uniform: [0.5, 1]},
    spin: {choice: [1, 2]}, overlap: allow}
  motion: {duration: 0.2, dt: 0.02}
  engine: {algorithm: grid}
  measure: {repeats: 1, timeout: 20, memory: 1GiB}
bodies:
  title: Bodies
  scene:
    mesh: cube.ply
    shape: mesh
    box: [4, 4, 4]
    bodies:
    - {position: [-1, 0, 0], velocity: [1, 0.1, 0], spin: [1, 1, 1], size: 1, mass: 1, orientation: [1, 0.5, 0, 0]}
    - {position: [1, 0, 0], velocity: [-1, 0, 0]}
  motion: {duration: 1, dt: 0.02, response: none}
  engine: {algorithm: predictive, tolerance: 1.0e-6}
  measure: {repeats: 1, timeout: 20, memory: 1GiB, reference: {tolerance: 1.0e-10}}
frames:
  title: Frames
  scene: {shape: sphere, count: 8, size: 1, box: [5, 5, 5]}
  motion: {duration: 0.5, dt: 0.02}
  engine: {backend: pybullet, algorithm: native}
  measure: {repeats: 1, timeout: 20, memory: 1GiB}
  sweep: {count: [4, 8], size: [0.5, 1], dt: [0.01, 0.02]}
"""


def numbers_of(document: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Where the numbers of a document stand."""
    if isinstance(document, dict | list):
        for key, value in document.items() if isinstance(document, dict) else enumerate(document):
            yield from numbers_of(value, (*path, key))
    elif not isinstance(document, str | bool):
        yield path


def changed(document: dict[str, Any], path: tuple[str | int, ...], value: object) -> dict[str, Any]:
    """A copy of a document with one entry replaced."""
    copy = deepcopy(document)
    place: Any = copy
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return copy


def planned_here(document: dict[str, Any], opened: dict[Path, Mesh]) -> None:
    """Import and compile what a plan needs in this process, so that the processes forked from it need not."""
    loaded = load_text(json.dumps(document), Path("extreme.yaml"))
    named = dict.fromkeys(loaded.mesh_paths.values(), next(iter(opened.values())))
    for point in loaded.points[:1]:
        plan_of(point, build_scene(point, files_of(loaded, point, named)))


def verdict(experiment: dict[str, Any], table: pd.DataFrame) -> tuple[str, str | None]:
    """What becomes of the criteria of an experiment, and what is wrong with that."""
    try:
        loaded = load_text(json.dumps(experiment), Path("extreme.yaml"))
    except InputError as error:
        unplaced = [str(problem) for problem in error.problems if problem.column is None]
        return "refused", f"no place: {unplaced}" if unplaced else None
    for kind, rows in (("expectation", loaded.expect), ("claim", loaded.claims)):
        for row in rows:
            try:
                verdict_on(row, table, loaded.swept, kind)
            except Exception as error:
                return "no verdict", f"{type(error).__name__}: {error}"
    return "judged", None


def tried(wanted: list[str], servers: Servers) -> Iterator[tuple[str, str, str | None, dict[str, Any]]]:
    """Leaf, what came of it, what is wrong with that, and the experiment, for each of the values of each leaf."""
    opened = meshes()
    for name, document in yaml.safe_load(EXPERIMENTS).items():
        table = None
        planned_here(document, opened)
        for path in numbers_of(document):
            leaf = f"{name}: {'.'.join(map(str, path))}"
            if wanted and not any(word in leaf for word in wanted):
                continue
            for value in VALUES:
                experiment = changed(document, path, value)
                if path[0] not in CRITERIA:
                    word, complaint = outcome(experiment, opened, servers)
                    if path[-1] in LIMITS and word in ("timeout", "memory"):
                        complaint = None  # as it was asked for
                else:
                    if table is None:
                        table = run(load_text(json.dumps(document), Path("extreme.yaml")), {})
                    word, complaint = verdict(experiment, table)
                yield leaf, word, complaint, experiment


def main(wanted: list[str]) -> None:
    """Every leaf, or those whose names hold one of the words."""
    found: dict[str, Counter[str]] = {}
    wrong = 0
    with Servers() as servers:
        for leaf, word, complaint, experiment in tried(wanted, servers):
            if leaf not in found and found:
                last = next(reversed(found))
                print(f"{last}: {dict(found[last])}", flush=True)
            found.setdefault(leaf, Counter())[word] += 1
            if complaint is not None:
                wrong += 1
                print(
                    f"--- {leaf}: {word}: {complaint}\n{yaml.safe_dump(experiment, default_flow_style=None)}",
                    flush=True,
                )
    total = sum(found.values(), Counter[str]())
    print(f"{len(found)} leaves, {total.total()} experiments: {dict(total.most_common())}; {wrong} not right")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
