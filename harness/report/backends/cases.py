"""Wrong verdicts as the page shows them: who was wrong, the proof, and the file that shows it again."""

from __future__ import annotations

from dataclasses import dataclass

from harness.report.backends.comparisons import Comparisons
from harness.report.backends.proof import sentences_of


@dataclass(frozen=True, eq=False)
class ShownCase:
    """A wrong verdict.

    Parameters
    ----------
    name : names its files
    bodies : numbers of the two
    section : of both, cut by a plane: segments of each
    text : the experiment that shows it by itself, and the mesh that this needs
    """

    name: str
    wrong: str
    bodies: tuple[int, int]
    section: list[list[list[float]]]
    sentences: list[str]
    text: str | None
    mesh: str | None
    experiment: str

    @property
    def title(self) -> str:
        """Who was wrong about whom."""
        return f"{self.wrong}, bodies {self.bodies[0]} and {self.bodies[1]}"

    @property
    def file(self) -> str:
        """Where its experiment lies."""
        return f"cases/{self.name}.yaml"


def shown_cases(compared: Comparisons) -> list[ShownCase]:
    """The first wrong verdicts of every backend."""
    rows = [(record.experiment, row) for record in compared.records for row in record.document["shown"]]
    found = []
    for place, (experiment, row) in enumerate(rows, 1):
        i, j = (row["minimised"] or row)["bodies"]
        found.append(
            ShownCase(
                name=f"case-{place}",
                wrong=row["wrong"],
                bodies=(i, j),
                section=row["section"],
                sentences=sentences_of(row),
                text=row["text"],
                mesh=row["mesh"] if row["shape"] != "sphere" else None,
                experiment=experiment,
            )
        )
    return found
