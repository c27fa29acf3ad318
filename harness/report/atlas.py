"""The atlas of correctness as the report has it: engines against families of poses, and where each goes wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from harness.report.backends.comparisons import Comparisons
from harness.report.backends.proof import sentences_of
from harness.store.records import ComparisonRecord


@dataclass(frozen=True, eq=False)
class AtlasPart:
    """One shape of one mesh, of one experiment.

    Parameters
    ----------
    experiment : its name
    title : what the bodies are, and what was asked of them
    query : "collision", "tolerance" or "distance"
    engines, families : in the order in which they are shown
    cells : by engine and family, as the database has them
    """

    experiment: str
    title: str
    query: str
    engines: Sequence[str]
    families: Sequence[str]
    cells: Mapping[tuple[str, str], Mapping[str, Any]]


@dataclass(frozen=True, eq=False)
class AtlasResults:
    """All atlases of a database.

    Parameters
    ----------
    records : of engines that were judged on families of poses
    """

    records: Sequence[ComparisonRecord]

    @classmethod
    def of(cls, compared: Comparisons) -> AtlasResults:
        """Those of the newest comparisons."""
        return cls([record for record in compared.records if record.document.get("atlas")])

    @cached_property
    def parts(self) -> list[AtlasPart]:
        """A matrix for every experiment, query, shape and mesh."""
        found: dict[tuple[str, str, str, str], dict[tuple[str, str], Mapping[str, Any]]] = {}
        for record in self.records:
            for cell in record.document["atlas"]:
                query = cell.get("query", "collision")  # databases of before other queries have none
                place = (record.experiment, query, cell["shape"], cell["mesh"])
                found.setdefault(place, {})[cell["engine"], cell["family"]] = cell | _shown(record, cell)
        return [
            AtlasPart(
                experiment,
                f"{'' if query == 'collision' else f'{query}, '}{shape}{f' of {mesh}' if mesh else ''}",
                query,
                sorted({engine for engine, _ in cells}),
                list(dict.fromkeys(family for _, family in cells)),
                cells,
            )
            for (experiment, query, shape, mesh), cells in sorted(found.items())
        ]

    @cached_property
    def overall(self) -> list[AtlasPart]:
        """Of each query that was asked of several kinds of bodies, a matrix of all of them together."""
        found = []
        queries = dict.fromkeys(part.query for part in self.parts)
        for query in sorted(queries, key=lambda query: query != "collision"):  # what most come for
            parts = [part for part in self.parts if part.query == query]
            if len(parts) > 1:
                families = dict.fromkeys(family for part in parts for family in part.families)
                engines = sorted({engine for part in parts for engine in part.engines})
                found.append(AtlasPart("", f"{query}, all bodies", query, engines, list(families), _together(parts)))
        return found

    @cached_property
    def files(self) -> dict[str, str]:
        """The smallest cases: experiments, and Python files that need the library alone."""
        found = {}
        for record in self.records:
            for place, row in enumerate(record.document["shown"]):
                stem = case_stem(record, place)
                if row["text"]:
                    found[f"{stem}.yaml"] = row["text"]
                if row.get("script"):
                    found[f"{stem}.py"] = row["script"]
        return found


def case_stem(record: ComparisonRecord, place: int) -> str:
    """Where the files of a case lie, without suffix."""
    name = f"{record.experiment}-{record.backends[0]}-{place}".replace("/", "-")
    return f"cases/{name}"


def _together(parts: Sequence[AtlasPart]) -> dict[tuple[str, str], Mapping[str, Any]]:
    """Verdicts of all parts, counted together by engine and family."""
    cells: dict[tuple[str, str], dict[str, Any]] = {}
    for part in parts:
        for place, cell in part.cells.items():
            counted = cells.setdefault(place, {"verdicts": 0, "wrong": 0, "beyond": 0})
            for name in counted:
                counted[name] += cell[name]
    return {
        place: cell | {"per_million": 1e6 * cell["wrong"] / cell["verdicts"] if cell["verdicts"] else None}
        for place, cell in cells.items()
    }


def _shown(record: ComparisonRecord, cell: Mapping[str, Any]) -> dict[str, Any]:
    """The smallest case of a cell in sentences, and its file: of Python, or else the experiment; empty without any."""
    place = cell["case"]
    if place is None or place >= len(record.document["shown"]):
        return {"file": "", "sentences": []}
    row = record.document["shown"][place]
    suffix = ".py" if row.get("script") else ".yaml" if row["text"] else ""
    return {"file": f"{case_stem(record, place)}{suffix}" if suffix else "", "sentences": sentences_of(row)}
