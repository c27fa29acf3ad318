"""The page of backends held against each other: who is right, proven, and what being right costs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import pandas as pd
from markupsafe import Markup

from harness.report.agreement import draw_gaps, draw_section
from harness.report.correctness import correctness
from harness.report.figures import Figure, Key
from harness.report.proof import sentences_of
from harness.report.quantity import number, plural
from harness.report.speeds import speed_table
from harness.report.table import Column, Entry, Table, plain, words
from harness.store.records import ComparisonRecord

KINDS = ("undecided", "containment", "approximation", "real")
TITLES = {
    "undecided": "undecided (inside the tolerance band)",
    "containment": "containment",
    "approximation": "approximation",
    "real": "real",
}


@dataclass(frozen=True, eq=False)
class ShownCase:
    """A wrong verdict as the page shows it."""

    title: str
    sentences: list[str]
    figure: Figure
    file: str
    text: str | None
    mesh: str | None
    experiment: str


@dataclass(frozen=True, eq=False)
class BackendsPage:
    """All that the page says.

    Parameters
    ----------
    records : the newest comparison of every two backends on every experiment
    runs : of all experiments, for what a frame costs
    """

    records: Sequence[ComparisonRecord]
    runs: pd.DataFrame

    @cached_property
    def pairs(self) -> list[dict[str, Any]]:
        """The tallies of all records, each with its experiment."""
        return [
            tally | {"experiment": record.experiment}
            for record in self.records
            for tally in record.document["pairs"]
            if tally["verdicts"]
        ]

    @cached_property
    def summary(self) -> list[Markup]:
        """What was found, in sentences."""
        verdicts = sum(tally["verdicts"] for tally in self.pairs)
        real = sum(tally["real"] for tally in self.pairs)
        undecided = sum(tally["undecided"] for tally in self.pairs)
        checked = [row for record in self.records for row in record.document["checked"]]
        judged, contradicted = sum(row["verdicts"] for row in checked), sum(row["contradicted"] for row in checked)
        crashed = sum(case["certificate"]["kind"] == "crashed" for case in self._cases)
        found = [
            Markup(
                "{} of two backends on the same poses: <strong>{}</strong> really disagree, {} lie inside a band."
            ).format(plural(verdicts, "verdict"), number(real) if real else "none", number(undecided))
        ]
        blamed: dict[str, int] = {}
        for case in self._cases:
            if case["certificate"]["kind"] != "crashed":
                blamed[case["wrong"]] = blamed.get(case["wrong"], 0) + 1
        for name, count in sorted(blamed.items()):
            found.append(Markup("<strong>{}</strong> was proven wrong {}.").format(name, plural(count, "time")))
        if crashed:
            found.append(Markup("A backend crashed or hung at {}.").format(plural(crashed, "pose")))
        both = (
            f"{number(contradicted)} of them are wrong, both backends alike"
            if contradicted
            else "all of them are right"
        )
        if judged:
            found.append(
                Markup("Of the verdicts that two agree on, {} were judged as well: {}.").format(number(judged), both)
            )
        return found

    @cached_property
    def matrix(self) -> Table:
        """Backend against backend: how their verdicts compare, over all experiments and shapes."""
        names = sorted({name for tally in self.pairs for name in tally["backends"]})
        columns = (Column("", numeric=False), *(Column(name, numeric=False) for name in names))
        rows = []
        for name in names:
            rows.append((words(name), *(self._meeting(name, other) for other in names)))
        return Table(
            "Matrix of backends",
            "Each entry sums up all poses that both were asked about: the share of verdicts that agree, then how many "
            "differ and why. Real is what neither a tolerance nor an approximation explains.",
            columns,
            tuple(rows),
        )

    @cached_property
    def by_experiment(self) -> Table:
        """Every pair of backends on every experiment and shape."""
        rows = []
        for tally in self.pairs:
            a, b = tally["backends"]
            crashes = sum(
                case["certificate"]["kind"] == "crashed"
                for record in self.records
                if record.experiment == tally["experiment"] and list(record.backends) == tally["backends"]
                for case in record.document["cases"]
            )
            rows.append(
                (
                    words(tally["experiment"]),
                    words(f"{a}, {b}"),
                    words(tally["shape"]),
                    *(_count(tally[name]) for name in ("poses", "verdicts", "agree", *KINDS[:3])),
                    _count(tally["real"], bad=True),
                    _count(crashes, bad=True),
                )
            )
        columns = (
            Column("Experiment", numeric=False), Column("Backends", numeric=False), Column("Shape", numeric=False),
            Column("poses"), Column("verdicts"), Column("agree"), Column("undecided"), Column("containment"),
            Column("approximation"), Column("real"), Column("crashes"),
        )  # fmt: skip
        note = "Poses as bodies fly through each other, and pairs put where verdicts are hard."
        return Table("By experiment", note, columns, tuple(rows))

    @cached_property
    def gaps(self) -> Figure | None:
        """Where on the axis of gaps they disagree."""
        rows: dict[str, dict[str, dict[int, int]]] = {}
        for record in self.records:
            for axis in record.document["gaps"]:
                row = rows.setdefault(f"{' and '.join(axis['backends'])}, {axis['shape']}", {})
                for kind, decades in axis["counts"].items():
                    counts = row.setdefault(kind, {})
                    for decade, count in decades.items():
                        counts[int(decade)] = counts.get(int(decade), 0) + count
        rows = {name: row for name, row in sorted(rows.items()) if row}
        if not rows:
            return None
        said = "; ".join(
            f"{name}: {', '.join(f'{number(sum(counts.values()))} {kind}' for kind, counts in row.items())}"
            for name, row in rows.items()
        )
        kinds = [kind for kind in KINDS if any(kind in row for row in rows.values())]
        return Figure(
            "gaps",
            "Where on the axis of gaps they disagree",
            f"Disagreements by pair of backends and by gap. {said}.",
            "To the left bodies overlap by as much, to the right they are so far apart, as a fraction of the smaller "
            "body's size; each column is a factor of ten. A larger mark stands for more disagreements.",
            lambda form, name: draw_gaps(rows, KINDS, form, name),
            tuple(Key(TITLES[kind], KINDS.index(kind)) for kind in kinds),
            labelled=False,
            file="backends-gaps.svg",
        )

    @cached_property
    def approximations(self) -> Table | None:
        """What it costs to put another shape in the place of the mesh."""
        rows = []
        for record in self.records:
            for one in record.document["approximations"]:
                if not one["reported"] and not one["touching"]:
                    continue
                other = next(name for name in one["backends"] if name != one["backend"])
                rows.append(
                    (
                        words(record.experiment), words(one["backend"]), words(other),
                        _count(one["touching"]), _count(one["reported"]),
                        _share(one["false_share"], one["false_hits"]), _count(one["contained"]),
                        _share(one["missed_share"], one["misses"]),
                    )
                )  # fmt: skip
        if not rows:
            return None
        columns = (
            Column("Experiment", numeric=False), Column("Backend", numeric=False), Column("against", numeric=False),
            Column("touching"), Column("reported"), Column("false hits", "of those reported"),
            Column("contained", "of the false"), Column("misses", "of those touching"),
        )  # fmt: skip
        note = (
            "These backends put a convex hull in the place of a mesh. As bodies fly, so many of the hits that they "
            "report are none, and so many pairs that touch they miss; where the other differs, the judge decides."
        )
        return Table("A hull in the place of a mesh", note, columns, tuple(rows))

    @cached_property
    def flights(self) -> Table | None:
        """Free flights side by side."""
        rows = []
        for record in self.records:
            for flight in record.document["flights"]:
                parted = flight["diverged"]
                for one in flight["afterwards"]:
                    rows.append(
                        (
                            words(record.experiment),
                            words(one["backend"]),
                            Entry(number(parted) if parted is not None else "never", sort=plain(parted)),
                            _count(flight["shared_hits"]),
                            Entry(number(one["pair_hits_per_second"]), sort=plain(one["pair_hits_per_second"])),
                            Entry(number(one["box_hits_per_second"]), sort=plain(one["box_hits_per_second"])),
                            Entry(number(one["energy_change"]), sort=plain(one["energy_change"])),
                        )
                    )
        if not rows:
            return None
        columns = (
            Column("Experiment", numeric=False), Column("Backend", numeric=False), Column("diverged", "s"),
            Column("hits shared", "before"), Column("pair hits", "1/s, after"), Column("wall hits", "1/s, after"),
            Column("energy", "relative change"),
        )  # fmt: skip
        note = (
            "Each backend flies the scene by its own hits. Until the first hit that only one of two answers, the "
            "flights are the same; after it chaos parts them, and only averages can be compared."
        )
        return Table("Bodies in flight", note, columns, tuple(rows))

    @cached_property
    def speeds(self) -> list[Table]:
        """What a frame costs, by scene, beside whether the answers are right; only who is right has a rank."""
        names = sorted({record.experiment for record in self.records})
        known = correctness(self.records)
        tables = (speed_table(name, self.runs, known) for name in names)
        return [table for table in tables if table is not None]

    @cached_property
    def cases(self) -> list[ShownCase]:
        """The wrong verdicts, each with picture, proof and file."""
        found: list[ShownCase] = []
        for record in self.records:
            for row in record.document["shown"]:
                found.append(_shown(record, row, len(found)))
        return found

    @cached_property
    def failures(self) -> list[str]:
        """Poses at which a backend crashed, hung or raised."""
        return [
            "{}: {} at {pose} (question {call}): {reason}".format(
                record.experiment, case["wrong"], **case["certificate"]
            )
            for record in self.records
            for case in record.document["cases"]
            if case["certificate"]["kind"] == "crashed"
        ]

    @cached_property
    def unsupported(self) -> list[str]:
        """What could not be compared, and why."""
        lines = [line for record in self.records for line in record.document["unsupported"]]
        return list(dict.fromkeys(lines))

    @cached_property
    def commands(self) -> list[str]:
        """How it was made."""
        return list(dict.fromkeys(record.command for record in self.records))

    def files(self) -> Iterator[tuple[str, str]]:
        """What lies beside the page: (path, text)."""
        if self.gaps:
            yield self.gaps.file, self.gaps.document
        for case in self.cases:
            yield case.figure.file, case.figure.document
            if case.text:
                yield case.file, case.text

    @property
    def _cases(self) -> list[dict[str, Any]]:
        return [case for record in self.records for case in [*record.document["cases"], *record.document["shared"]]]

    def _meeting(self, name: str, other: str) -> Entry:
        if name == other:
            return words("")
        met = [tally for tally in self.pairs if set(tally["backends"]) == {name, other}]
        verdicts = sum(tally["verdicts"] for tally in met)
        if not verdicts:
            return words("not compared")
        share = _percent(sum(tally["agree"] for tally in met) / verdicts)
        counts = {kind: sum(tally[kind] for tally in met) for kind in KINDS}
        said = ", ".join(f"{number(count)} {kind}" for kind, count in counts.items() if count and kind != "real")
        flag = f"{number(counts['real'])} real" if counts["real"] else ""
        return Entry(share, small=said, numeric=False, flag=flag)


def _shown(record: ComparisonRecord, row: Mapping[str, Any], place: int) -> ShownCase:
    name = f"case-{place + 1}"
    i, j = (row["minimised"] or row)["bodies"]
    title = f"{row['wrong']}, bodies {i} and {j}"
    said = sentences_of(row)
    return ShownCase(
        title=title,
        sentences=said,
        figure=Figure(
            name,
            f"Case {place + 1}: both bodies, cut through their centres",
            said[0],
            "Both bodies cut by a plane through their centres and the place of contact.",
            lambda form, drawn: draw_section(row["section"], drawn),
            (Key(f"body {i}", 0), Key(f"body {j}", 2)),
            labelled=False,
            file=f"cases/{name}.svg",
        ),
        file=f"cases/{name}.yaml",
        text=row["text"],
        mesh=row["mesh"] if row["shape"] != "sphere" else None,
        experiment=record.experiment,
    )


def _count(value: float, bad: bool = False) -> Entry:
    if bad and value:
        return Entry("", flag=number(value), sort=plain(value))
    return Entry(number(value), sort=plain(value))


def _share(value: float, count: int) -> Entry:
    return Entry(f"{100 * value:.3g} %", small=f"({number(count)})", sort=plain(value))


def _percent(share: float) -> str:
    """As many nines as there are: 99.99 % is not 100 %."""
    if share == 1.0:
        return "100 %"
    digits = max(1, math.ceil(-math.log10(1 - share)) - 1)
    return f"{math.floor(share * 10 ** (digits + 2)) / 10**digits:.{digits}f} %"
