"""Loads experiments: every check that needs no mesh, and all that is wrong with a file at once."""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

from pydantic import BaseModel, TypeAdapter, ValidationError

from harness.errors import InputError, NotInstalledError, Problem
from harness.experiment.combinations import AbilitiesOf
from harness.experiment.criterion import Criterion
from harness.experiment.declaration import apply_override, check, check_backends, declare
from harness.experiment.document import KEY, KeyPath, read_document, read_value
from harness.experiment.expand import Expansion, expand
from harness.experiment.experiment import Experiment
from harness.experiment.files import name_of, no_file, path_kind
from harness.experiment.kind import LARGEST_FILE
from harness.experiment.leaves import LEAVES, SECTIONS, mesh_names_in, unknown_key
from harness.experiment.mesh_location import locate_mesh
from harness.experiment.messages import near, shown
from harness.experiment.presentation import Published, ReportSpec
from harness.experiment.problems import FileProblems, Origin, Override
from harness.experiment.schema import MOST_RUNS, MeasureSpec, Text

KEYS = (
    *("title", "question", *SECTIONS, "sweep", "zip", "exclude", "include"),
    *("measure", "expect", "claims", "published", "report"),
)
# Leaf -> where it was set, and to what.
Overrides = dict[str, tuple[Override, Any]]
_NOTHING: Mapping[str, object] = MappingProxyType({})
_TEXT: TypeAdapter[str] = TypeAdapter(Text)
_Model = TypeVar("_Model", bound=BaseModel)


@dataclass(frozen=True)
class Names:
    """Names that only other folders know, and what stands behind them."""

    backends: Collection[str]
    metrics: Collection[str]
    abilities_of: AbilitiesOf | None = None
    """What a backend of these can be asked; None to look at none of that."""


def load(path: str | os.PathLike[str], set: Mapping[str, object] = _NOTHING, names: Names | None = None) -> Experiment:
    """Load an experiment.

    Parameters
    ----------
    path : of its YAML file
    set : leaf -> value, over what the file says; a value that is text is read as YAML
    names : that there are; None to take any

    Raises
    ------
    InputError
        With everything that is wrong with it.
    """
    return load_text(_read(Path(path)), path, set, names)


def load_text(
    text: str | bytes,
    path: str | os.PathLike[str],
    set: Mapping[str, object] = _NOTHING,
    names: Names | None = None,
) -> Experiment:
    """As `load`, from text; `path` names it in messages, and meshes are looked for beside it."""
    path = Path(path)
    document = read_document(text, str(path))
    file: dict[str, Any] = document.value
    problems = FileProblems(document)
    for key in file:
        if key not in KEYS:
            problems.add((key, KEY), unknown_key(key, KEYS))
    overrides = _overrides(set, problems)
    declaration = declare(file, problems)
    for leaf, (override, value) in overrides.items():
        if leaf in LEAVES:
            apply_override(declaration, override, value, problems)
    check(declaration, problems)
    if names is not None:
        check_backends(declaration, names.backends, problems)

    if not _is_text(name_of(path)):
        problems.add((), "the name of this file is not UTF-8, and results are kept by name: rename it")
    title = _text(file, "title", overrides, problems)
    if title is None and file.get("title") is None:
        problems.add((), '"title" is missing')
    question = _text(file, "question", overrides, problems)
    measure = _measure(file, overrides, problems)
    expect = _criteria(file, "expect", problems)
    claims = _criteria(file, "claims", problems)
    published = _section(Published, file, "published", problems)
    report = _section(ReportSpec, file, "report", problems)
    if names is not None:
        _check_metrics(file, names.metrics, problems)
    abilities_of = names.abilities_of if names is not None else None
    expansion = expand(declaration, measure or MeasureSpec(repeats=1, max_runs=MOST_RUNS), problems, abilities_of)
    meshes = _locate_meshes(expansion, path.parent, problems)
    poses = _locate_poses(expansion, path.parent, problems)
    problems.raise_any()
    assert title is not None
    assert measure is not None
    return Experiment(
        path=path,
        name=name_of(path),
        title=title,
        question=question,
        points=expansion.points,
        swept=expansion.swept,
        measure=measure,
        expect=expect,
        claims=claims,
        published=published,
        report=report,
        mesh_paths=meshes,
        poses_paths=poses,
        source=text if isinstance(text, str) else text.decode("utf-8-sig"),
        overrides=dict(set),
        document=document,
        origins=expansion.origins,
    )


def _is_text(name: str) -> bool:
    """Whether it came from bytes that are UTF-8."""
    return not any("\ud800" <= letter <= "\udfff" for letter in name)


def _read(path: Path) -> bytes:
    file = str(path)
    named = path_kind(path)
    if named is None:
        raise InputError([Problem(no_file(path), file)])
    if named == "folder":
        raise InputError([Problem("this is a folder; name a file", file)])
    if named != "file":
        raise InputError([Problem("this is not a file", file)])
    try:
        with path.open("rb") as stream:
            return stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise InputError([Problem(f"the file cannot be read: {error.strerror}", file)]) from None


def _overrides(given: Mapping[str, object], problems: FileProblems) -> Overrides:
    """The overrides with their values, text read as YAML; title and question are text as they stand."""
    overrides: Overrides = {}
    settable = ("title", "question", *LEAVES, *MeasureSpec.model_fields)
    for leaf, value in given.items():
        override = Override(leaf, value)
        if leaf not in settable:
            unknown = f"unknown leaf {shown(leaf)}{near(leaf, settable)}"
            problems.add(override, f"{shown(leaf)} cannot be set; only leaves can" if leaf in KEYS else unknown)
        elif leaf in ("title", "question") or not isinstance(value, str):
            overrides[leaf] = (override, value)
        else:
            try:
                overrides[leaf] = (override, read_value(value))
            except InputError as error:
                for problem in error.problems:
                    problems.add(override, problem.message)
    return overrides


def _text(file: Mapping[str, Any], key: str, overrides: Overrides, problems: FileProblems) -> str | None:
    origin: Origin
    origin, value = overrides.get(key, ((key,), file.get(key)))
    if value is None:
        return None
    try:
        return _TEXT.validate_python(value)
    except ValidationError as error:
        problems.add_errors(origin, error)
        return None


def _measure(file: Mapping[str, Any], overrides: Overrides, problems: FileProblems) -> MeasureSpec | None:
    written = file.get("measure")
    if written is not None and not isinstance(written, dict):
        return _section(MeasureSpec, file, "measure", problems)
    set_here = {name: override for name, override in overrides.items() if name in MeasureSpec.model_fields}
    values = {**(written or {}), **{name: value for name, (_, value) in set_here.items()}}
    try:
        return MeasureSpec.model_validate(values)
    except ValidationError as error:
        for found in error.errors(include_url=False):
            name = str(found["loc"][0])
            origin: Origin = set_here[name][0] if name in set_here else ("measure",)
            problems.add_error(origin, found, MeasureSpec)
        return None


def _section(model: type[_Model], file: Mapping[str, Any], key: str, problems: FileProblems) -> _Model | None:
    if file.get(key) is None:
        return None
    try:
        return model.model_validate(file[key])
    except ValidationError as error:
        problems.add_errors((key,), error, model)
        return None


def _criteria(file: Mapping[str, Any], key: str, problems: FileProblems) -> tuple[Criterion, ...]:
    rows = file.get(key)
    if rows is None:
        return ()
    if not isinstance(rows, list):
        problems.add((key,), f"must be a list of rows, such as [{{metric: escaped, equals: 0}}], not {shown(rows)}")
        return ()
    found = []
    for place, row in enumerate(rows):
        try:
            found.append(Criterion.model_validate(row))
        except ValidationError as error:
            problems.add_errors((key, place), error, Criterion)
    return tuple(found)


def _check_metrics(file: Mapping[str, Any], metrics: Collection[str], problems: FileProblems) -> None:
    """Report metrics that there are not, wherever a file names one."""
    named: list[tuple[KeyPath, Any]] = []
    for section in ("expect", "claims"):
        for place, row in enumerate(_sequence(file.get(section))):
            if isinstance(row, dict) and "metric" in row:
                named.append(((section, place, "metric"), row["metric"]))
    report = file.get("report")
    y = report.get("y") if isinstance(report, dict) else None
    named += [(("report", "y", place), name) for place, name in enumerate([y] if isinstance(y, str) else _sequence(y))]
    for path, name in named:
        if isinstance(name, str) and name not in metrics:
            problems.add(path, f"unknown metric {shown(name)}{near(name, metrics)}")


def _sequence(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _locate_meshes(expansion: Expansion, folder: Path, problems: FileProblems) -> dict[str, Path]:
    """The files of all meshes that points refer to."""
    located: dict[str, Path] = {}
    for (leaf, text), origin in expansion.origins.items():
        for below, reference in mesh_names_in(leaf, json.loads(text)):
            try:
                located[reference] = locate_mesh(reference, folder)
            except NotInstalledError as error:
                problems.add_not_installed(origin, str(error))
            except InputError as error:
                problems.add((*origin, *below) if isinstance(origin, tuple) else origin, str(error))
    return located


def _locate_poses(expansion: Expansion, folder: Path, problems: FileProblems) -> dict[str, Path]:
    """The files of all recorded poses that points refer to, which lie beside the experiment or below."""
    located: dict[str, Path] = {}
    for (leaf, text), origin in expansion.origins.items():
        if leaf != "poses" or (name := json.loads(text)) is None:
            continue
        path = Path(os.path.realpath(folder / name))  # unlike Path.resolve, without an error for links in a circle
        if not path.is_relative_to(folder.resolve()):
            problems.add(origin, f"the poses {shown(name)} lie outside of the experiment's folder")
        elif not os.path.isfile(path):  # False, too, of a name that is too long
            problems.add(origin, f"there are no poses {shown(name)} beside the experiment")
        else:
            located[name] = path
    return located
