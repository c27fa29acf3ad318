"""Everything that is wrong with one experiment, gathered so that it is reported at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from harness.errors import InputError, NotInstalledError, Problem
from harness.experiment.document import KEY, Document, KeyPath
from harness.experiment.messages import flow, printable, sentence

MOST_REPORTED = 100
LISTS_OF_ROWS = ("zip", "exclude", "include", "expect", "claims", "rows", "bodies")


@dataclass(frozen=True)
class Override:
    """A leaf that was set outside of the file: with `--set`, whose text is given, or from Python, with its value."""

    leaf: str
    given: Any

    def __str__(self) -> str:
        return printable(f"--set {self.leaf}={self.given if isinstance(self.given, str) else flow(self.given)}")


# Where a value comes from: a key path in the file, or outside it.
Origin = KeyPath | Override


class FileProblems:
    """The problems found in one file, each with the place of the wrong value."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.found = list(document.problems)
        self.not_installed: list[Problem] = []

    def add(self, origin: Origin, message: str) -> None:
        """Keep a problem with the value from `origin`."""
        self.found.append(problem_at(self.document, origin, message))

    def add_not_installed(self, origin: Origin, message: str) -> None:
        """Keep that the value from `origin` asks for what is not installed."""
        self.not_installed.append(problem_at(self.document, origin, message))

    def add_errors(self, origin: Origin, error: ValidationError, model: Any = None) -> None:
        """Keep all that pydantic found wrong with the value from `origin`."""
        for found in error.errors(include_url=False):
            # A list all of whose items are wrong counts as empty too; it is not.
            if not (found["type"] == "too_short" and found["input"]):
                self.add_error(origin, found, model)

    def add_error(self, origin: Origin, found: Mapping[str, Any], model: Any = None) -> None:
        """Keep one of pydantic's errors with the value from `origin`."""
        place = origin if isinstance(origin, Override) else (*origin, *_steps(found))
        self.add(place, sentence(found, model))

    def raise_any(self) -> None:
        """Raise all problems in the order of the file, as one `InputError`, if there are any.

        Where there are none, but something is not installed, that is a `NotInstalledError`.
        """
        if self.not_installed and not self.found:
            raise NotInstalledError(self.not_installed)
        if not self.found:
            return
        ordered = sorted(dict.fromkeys(self.found), key=lambda problem: (problem.line or 0, problem.column or 0))
        if len(ordered) > MOST_REPORTED:
            first = ordered[MOST_REPORTED]
            rest = f"and {len(ordered) - MOST_REPORTED} problems more, from here on"
            ordered = [*ordered[:MOST_REPORTED], Problem(rest, first.file, first.line, first.column)]
        raise InputError(ordered)


def problem_at(document: Document, origin: Origin, message: str) -> Problem:
    """A problem with the value from `origin`."""
    if isinstance(origin, Override):
        return Problem(f"{origin}: {message}")
    subject = _subject(origin) if message.startswith(("must ", "needs ")) else ""
    return document.problem(origin, subject + message)


def _subject(path: KeyPath) -> str:
    """The subject of a sentence about the value at a path: its key, or a row of one of the lists of rows."""
    keys = [step for step in path if isinstance(step, str) and step != KEY]
    row = "a row of " if path and isinstance(path[-1], int) and keys[-1] in LISTS_OF_ROWS else ""
    return f"{row}{printable(keys[-1])} " if keys else ""


def _steps(error: Mapping[str, Any]) -> KeyPath:
    """An error's location within the value; the kinds of a distribution, which pydantic names too, are no steps."""
    steps = tuple(step for step in error["loc"] if step not in ("constant", "file"))
    return (*steps, KEY) if error["type"] == "extra_forbidden" else steps
