"""How right a method is: what the comparisons of backends have found of it, and of no other method.

A comparison says of each method that took part how many of its verdicts were held against another's, and which were
proven wrong. Of a method that took part in none, nothing is known: another method of the same backend says nothing of
it, for a broad phase can lose pairs that the backend would have seen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.store.records import ComparisonRecord
from harness.vocabulary import MethodName, Query


@dataclass(frozen=True)
class Correctness:
    """What is known of every method that was compared.

    Parameters
    ----------
    verdicts : by method, how many of its verdicts were held against another method's
    wrong : by method, how often it was wrong outside of its tolerance, or failed
    in_part : those of which a comparison left something out
    where : by method, the experiments at whose poses it was wrong
    """

    verdicts: Mapping[MethodName, int] = field(default_factory=dict)
    wrong: Mapping[MethodName, int] = field(default_factory=dict)
    in_part: frozenset[MethodName] = frozenset()
    where: Mapping[MethodName, tuple[str, ...]] = field(default_factory=dict)

    def is_wrong(self, method: MethodName) -> bool:
        """Whether it was proven wrong, or failed."""
        return self.wrong.get(method, 0) > 0

    def is_right(self, method: MethodName) -> bool:
        """Whether it was compared, and never wrong."""
        return self.verdicts.get(method, 0) > 0 and not self.is_wrong(method)


def correctness(records: Sequence[ComparisonRecord]) -> Correctness:
    """What comparisons have found, method by method.

    A wrong verdict counts for its shape and its query; a failure, and a verdict of a database that knows no shape of
    it, for every shape and query of its comparison.
    """
    verdicts: Counter[MethodName] = Counter()
    wrong: Counter[MethodName] = Counter()
    in_part: set[MethodName] = set()
    where: dict[MethodName, dict[str, None]] = {}
    for record in records:
        tallies = record.document["pairs"]
        for tally in tallies:
            for name in tally["backends"]:
                method = MethodName.read(name, tally["shape"], _query(tally))
                verdicts[method] += tally["verdicts"]
                if record.document.get("left_out"):
                    in_part.add(method)
        for case in record.document["cases"] + record.document["shared"] + record.document.get("findings", []):
            asked = {(tally["shape"], _query(tally)) for tally in tallies}
            if case.get("shape"):
                asked = {(case["shape"], _query(case))}
            for shape, query in sorted(asked):
                for name in case["wrong"].split(" and "):
                    method = MethodName.read(name, shape, query)
                    wrong[method] += 1
                    where.setdefault(method, {})[record.experiment] = None
    return Correctness(verdicts, wrong, frozenset(in_part), {method: tuple(names) for method, names in where.items()})


def _query(row: Mapping[str, Any]) -> Query:
    """What was asked; a row names it where it is not collision."""
    query: Query = row.get("query", "collision")
    return query


def newest(records: Sequence[ComparisonRecord]) -> list[ComparisonRecord]:
    """Of several comparisons of the same two methods on an experiment the newest: names may be written two ways."""
    found: dict[tuple[str, frozenset[str]], ComparisonRecord] = {}
    for record in sorted(records, key=lambda record: record.made):
        # a name is read the same on every shape
        pipelines = frozenset(MethodName.read(name, "mesh").pipeline for name in record.backends)
        found[record.experiment, pipelines] = record
    kept = {id(record) for record in found.values()}
    return [record for record in records if id(record) in kept]
