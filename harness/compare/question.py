"""What methods are asked when they are compared: a query of `engine.query`, and how it was set."""

from __future__ import annotations

from dataclasses import dataclass

from harness.vocabulary import NEAR_QUERIES, Query


@dataclass(frozen=True)
class Question:
    """A query as a run has it.

    Parameters
    ----------
    query : Query
    within : m, up to which gap pairs are near; of "tolerance" and "distance"
    tolerance : of size, which a method that has such a knob is handed for gaps and times
    """

    query: Query = "collision"
    within: float = 0.0
    tolerance: float = 1e-6

    def scaled(self, factor: float) -> Question:
        """The same question about bodies that are larger by a factor."""
        return Question(self.query, factor * self.within, self.tolerance)

    @property
    def text(self) -> str:
        """For a person, such as "distance within 0.05 m"."""
        return f"{self.query} within {self.within:g} m" if self.query in NEAR_QUERIES else self.query


COLLISION = Question()
