"""Experiment files: which ones paths name, and by which name the results of each are kept."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import Literal

from harness.errors import InputError, Problem
from harness.experiment import FOLDER
from harness.experiment.kind import is_truth_declaration
from harness.experiment.messages import near


def name_of(path: Path) -> str:
    """The name of an experiment: its path below the nearest folder experiments/, else its file's, without .yaml."""
    absolute = Path(os.path.abspath(path))
    *folders, file = absolute.parts
    below = folders[len(folders) - folders[::-1].index(FOLDER) :] if FOLDER in folders else []
    return "/".join([*below, file.removesuffix(".yaml").removesuffix(".yml")])


def find_experiments(paths: Iterable[str | os.PathLike[str]]) -> list[Path]:
    """The experiment files that paths name: files as they are, folders with every *.yaml below them, sorted.

    Raises
    ------
    InputError
        For paths that are not there and folders without an experiment, all of them at once.
    """
    found: dict[Path, Path] = {}
    problems: list[Problem] = []
    for path in map(Path, paths):
        kind = path_kind(path)
        if kind == "folder":
            files = sorted(file for file in path.rglob("*.yaml") if file.is_file() and not is_truth_declaration(file))
            if not files:
                problems.append(Problem("there is no experiment (*.yaml) in this folder", str(path)))
        elif kind is not None:
            files = [path]
            if is_truth_declaration(path):
                message = "this declares a set of cases, no experiment; `harness truth make` makes it"
                problems.append(Problem(message, str(path)))
        else:
            files = []
            problems.append(Problem(no_file(path), str(path)))
        for file in files:
            found.setdefault(file.resolve(), file)
    if problems:
        raise InputError(problems)
    return list(found.values())


def no_file(path: Path) -> str:
    """What to say of a path that names nothing."""
    guesses = (path.with_name(path.name + ".yaml"), FOLDER / path, FOLDER / path.with_name(path.name + ".yaml"))
    for guess in guesses if path.name else ():
        if path_kind(guess) == "file":
            return f'there is no such file or folder; did you mean "{guess}"?'
    siblings = [file.name for file in path.parent.glob("*.yaml")] if path.parent.is_dir() else []
    return f"there is no such file or folder{near(path.name, siblings)}"


def path_kind(path: Path) -> Literal["file", "folder", "other"] | None:
    """What a path names; nothing, if it cannot be looked at."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return None
    return "folder" if stat.S_ISDIR(mode) else "file" if stat.S_ISREG(mode) else "other"
