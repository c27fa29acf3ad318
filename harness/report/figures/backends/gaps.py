"""Where on the axis of gaps backends disagree."""

from __future__ import annotations

from harness.report.backends.comparisons import KINDS, Comparisons
from harness.report.drawing.gaps import draw_gaps
from harness.report.figure import Figure, FigureSource, Key
from harness.report.quantity import number

_TITLES = {
    "undecided": "undecided (inside the tolerance band)",
    "containment": "containment",
    "approximation": "approximation",
    "real": "real",
}


def _figures(compared: Comparisons) -> list[Figure]:
    rows: dict[str, dict[str, dict[int, int]]] = {}
    for record in compared.records:
        for axis in record.document["gaps"]:
            row = rows.setdefault(f"{' and '.join(axis['backends'])}, {axis['shape']}", {})
            for kind, decades in axis["counts"].items():
                counts = row.setdefault(kind, {})
                for decade, count in decades.items():
                    counts[int(decade)] = counts.get(int(decade), 0) + count
    rows = {name: row for name, row in sorted(rows.items()) if row}
    if not rows:
        return []
    said = "; ".join(
        f"{name}: {', '.join(f'{number(sum(counts.values()))} {kind}' for kind, counts in row.items())}"
        for name, row in rows.items()
    )
    kinds = [kind for kind in KINDS if any(kind in row for row in rows.values())]
    figure = Figure(
        "gaps",
        "Where on the axis of gaps they disagree",
        f"Disagreements by pair of backends and by gap. {said}.",
        "To the left bodies overlap by as much, to the right they are so far apart, as a fraction of the smaller "
        "body's size; each column is a factor of ten. A larger mark stands for more disagreements.",
        lambda form, name: draw_gaps(rows, KINDS, form, name),
        tuple(Key(_TITLES[kind], KINDS.index(kind)) for kind in kinds),
        labelled=False,
        file="backends-gaps.svg",
    )
    return [figure]


SOURCE = FigureSource(_figures, section="gaps")
