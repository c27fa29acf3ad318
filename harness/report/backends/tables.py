"""The tables of backends that were compared: who agrees with whom, where, what a hull costs, and in flight."""

from __future__ import annotations

import math

from harness.report.backends.comparisons import KINDS, Comparisons
from harness.report.quantity import number
from harness.report.table import Column, Entry, Table, counted, counted_bad, plain, words


def agreement(compared: Comparisons) -> Table:
    """Backend against backend: how their verdicts compare, over all experiments and shapes."""
    names = sorted({name for tally in compared.pairs for name in tally["backends"]})
    columns = (Column("backend", numeric=False), *(Column(name, numeric=False) for name in names))
    rows = []
    for name in names:
        rows.append((words(name), *(_meeting(compared, name, other) for other in names)))
    return Table(
        "Matrix of backends",
        "Each entry sums up all poses that both were asked about: the share of verdicts that agree, then how many "
        "differ and why. Real is what neither a tolerance nor an approximation explains.",
        columns,
        tuple(rows),
    )


def by_experiment(compared: Comparisons) -> Table:
    """Every pair of backends on every experiment and shape."""
    rows = []
    for tally in compared.pairs:
        a, b = tally["backends"]
        crashes = sum(
            case["certificate"]["kind"] == "crashed"
            for record in compared.records
            if record.experiment == tally["experiment"] and list(record.backends) == tally["backends"]
            for case in record.document["cases"]
        )
        rows.append(
            (
                words(tally["experiment"]),
                words(f"{a}, {b}"),
                words(tally["shape"]),
                words(tally.get("query", "collision")),
                *(counted(tally[name]) for name in ("poses", "verdicts", "agree", *KINDS[:3])),
                counted_bad(tally["real"]),
                counted_bad(crashes),
            )
        )
    columns = (
        Column("Experiment", numeric=False), Column("Backends", numeric=False), Column("Shape", numeric=False),
        Column("Query", numeric=False), Column("poses"), Column("verdicts"), Column("agree"), Column("undecided"),
        Column("containment"), Column("approximation"), Column("real"), Column("crashes"),
    )  # fmt: skip
    note = (
        "Poses as bodies fly through each other, and pairs put where verdicts are hard; of query impact, frames. A "
        "verdict is whether a pair is reported, and of distance and impact also its gap or its time. Of a method that "
        "computes events, a verdict is a contact that begins while bodies approach: when it does, or that it does, is "
        "held against exact arithmetic."
    )
    return Table("By experiment", note, columns, tuple(rows))


def approximations(compared: Comparisons) -> Table | None:
    """What it costs to put another shape in the place of the mesh."""
    rows = []
    for record in compared.records:
        for one in record.document["approximations"]:
            if not one["reported"] and not one["touching"]:
                continue
            other = next(name for name in one["backends"] if name != one["backend"])
            rows.append(
                (
                    words(record.experiment), words(one["backend"]), words(other),
                    counted(one["touching"]), counted(one["reported"]),
                    _share(one["false_share"], one["false_hits"]), counted(one["contained"]),
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


def flights(compared: Comparisons) -> Table | None:
    """Free flights side by side."""
    rows = []
    for record in compared.records:
        for flight in record.document["flights"]:
            parted = flight["diverged"]
            for one in flight["afterwards"]:
                rows.append(
                    (
                        words(record.experiment),
                        words(one["backend"]),
                        words(next(name for name in flight["backends"] if name != one["backend"])),
                        Entry(number(parted) if parted is not None else "never", sort=plain(parted)),
                        counted(flight["shared_hits"]),
                        counted(one["pair_hits_per_second"]),
                        counted(one["box_hits_per_second"]),
                        counted(one["energy_change"]),
                    )
                )
    if not rows:
        return None
    columns = (
        Column("Experiment", numeric=False), Column("Backend", numeric=False), Column("beside", numeric=False),
        Column("diverged", "s"), Column("hits shared", "before"), Column("pair hits", "1/s, after"),
        Column("wall hits", "1/s, after"), Column("energy", "relative change"),
    )  # fmt: skip
    note = (
        "With each backend the bodies move by its own hits. Until the first hit that only one of two answers, the "
        "motions are the same; after it chaos parts them, and only averages can be compared. Where they "
        "never diverge, those are of the whole flight."
    )
    return Table("Bodies in flight", note, columns, tuple(rows))


def _meeting(compared: Comparisons, name: str, other: str) -> Entry:
    if name == other:
        return words("")
    shared = [tally for tally in compared.pairs if set(tally["backends"]) == {name, other}]
    verdicts = sum(tally["verdicts"] for tally in shared)
    if not verdicts:
        return words("not compared")
    share = _percent(sum(tally["agree"] for tally in shared) / verdicts)
    counts = {kind: sum(tally[kind] for tally in shared) for kind in KINDS}
    listed = ", ".join(f"{number(count)} {kind}" for kind, count in counts.items() if count and kind != "real")
    flag = f"{number(counts['real'])} real" if counts["real"] else ""
    return Entry(share, small=listed, numeric=False, flag=flag)


def _share(value: float, count: int) -> Entry:
    return Entry(f"{100 * value:.3g} %", small=f"({number(count)})", sort=plain(value))


def _percent(share: float) -> str:
    """As many nines as there are: 99.99 % is not 100 %."""
    if share == 1.0:
        return "100 %"
    digits = max(1, math.ceil(-math.log10(1 - share)) - 1)
    return f"{math.floor(share * 10 ** (digits + 2)) / 10**digits:.{digits}f} %"
