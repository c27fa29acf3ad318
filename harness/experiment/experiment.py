"""An experiment, loaded: its points, how to measure them, and what is expected of the numbers."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.errors import Problem
from harness.experiment.criterion import Criterion
from harness.experiment.document import Document
from harness.experiment.leaves import identity, mesh_names_in, plain
from harness.experiment.presentation import Published, ReportSpec
from harness.experiment.problems import Origin, problem_at
from harness.experiment.schema import EngineSpec, MeasureSpec, MotionSpec, ReferenceSpec, SceneSpec
from harness.vocabulary import Shape


@dataclass(frozen=True)
class Reference:
    """What the errors of a point are measured against: such a run of the same motion.

    Parameters
    ----------
    spec : as the experiment declares it
    shape : the most exact of all shapes that the experiment has, the others being approximations of it
    """

    spec: ReferenceSpec
    shape: Shape


@dataclass(frozen=True)
class Point:
    """One combination of values, fully resolved: what a run is to do, and what it is measured against."""

    scene: SceneSpec
    motion: MotionSpec
    engine: EngineSpec
    reference: Reference | None = None

    @property
    def parameters(self) -> dict[str, Any]:
        """Every leaf of scene, motion and engine, in the order of the schema, as JSON holds it."""
        return {**plain(self.scene), **plain(self.motion), **plain(self.engine)}


@dataclass(frozen=True)
class Experiment:
    """All of an experiment, checked.

    Parameters
    ----------
    path : its file, as the user gave it
    name : the path below the folder experiments/, else the file's name, without .yaml
    points : in order, the leaf that is swept first varying slowest
    swept : the leaves that differ between points, in the order of the file
    mesh_paths : the file of every mesh that the points refer to
    source : the text of the file
    overrides : what was set from outside, as it was given
    """

    path: Path
    name: str
    title: str
    question: str | None
    points: tuple[Point, ...]
    swept: tuple[str, ...]
    measure: MeasureSpec
    expect: tuple[Criterion, ...]
    claims: tuple[Criterion, ...]
    published: Published | None
    report: ReportSpec | None
    mesh_paths: dict[str, Path]
    source: str
    overrides: dict[str, Any]
    document: Document = field(repr=False)
    origins: Mapping[tuple[str, str], Origin] = field(repr=False)

    @property
    def runs(self) -> int:
        """How many runs it takes."""
        return len(self.points) * self.measure.repeats

    @property
    def metrics(self) -> frozenset[str]:
        """The metrics that its expectations, claims and report name."""
        named = {row.metric for row in (*self.expect, *self.claims)}
        return frozenset(named.union(self.report.y if self.report else ()))

    def problem(self, path: Sequence[str | int], message: str) -> Problem:
        """A problem with the value at a key path of the file, such as ('scene', 'mesh')."""
        return self.document.problem(path, message)

    def mesh_problems(self, name: str, message: str) -> Iterator[Problem]:
        """A problem with a mesh of this name, at every place that names it."""
        for (leaf, text), origin in self.origins.items():
            for below, found in mesh_names_in(leaf, json.loads(text)):
                if found == name:
                    place = (*origin, *below) if isinstance(origin, tuple) else origin
                    yield problem_at(self.document, place, message)

    def leaf_problem(self, leaf: str, value: Any, message: str, below: Sequence[str | int] = ()) -> Problem:
        """A problem with one of the values that a leaf has, at the place that gives it: base, sweep or --set.

        Parameters
        ----------
        leaf, value : whose value it is
        message : what is wrong with it
        below : the keys within the value that lead to what is wrong
        """
        origin = self.origins.get((leaf, identity(value)))
        if isinstance(origin, tuple):
            origin = (*origin, *below)
        return problem_at(self.document, origin if origin is not None else (), message)
