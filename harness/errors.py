"""Errors in the input, not in the program: a sentence for a person, with the place to correct."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with the input, and where.

    Parameters
    ----------
    message : what is wrong and what to do about it
    file : the file it stands in, if it stands in one
    line, column : counted from 1

    Examples
    --------
    >>> print(Problem('unknown key "cuont"; did you mean "count"?', "experiments/mine.yaml", 7, 3))
    experiments/mine.yaml:7:3: unknown key "cuont"; did you mean "count"?
    """

    message: str
    file: str | None = None
    line: int | None = None
    column: int | None = None

    def __str__(self) -> str:
        place = [str(part) for part in (self.file, self.line, self.column) if part is not None]
        return ": ".join([":".join(place), self.message]) if place else self.message


class InputError(Exception):
    """Wrong input; every problem found, not just the first. Commands print them and exit with 2."""

    def __init__(self, problems: str | Iterable[Problem]) -> None:
        self.problems = (Problem(problems),) if isinstance(problems, str) else tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))


class NotInstalledError(InputError):
    """The input is right, but asks for what this machine does not have: among others it is passed over."""
