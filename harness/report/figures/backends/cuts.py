"""The two bodies of every wrong verdict that is shown, cut by a plane."""

from __future__ import annotations

from collections.abc import Iterator

from harness.report.backends.cases import ShownCase, shown_cases
from harness.report.backends.comparisons import Comparisons
from harness.report.drawing.cuts import draw_cut
from harness.report.figure import Figure, FigureSource, Key


def _figures(compared: Comparisons) -> Iterator[Figure]:
    """One a case, in the order of the cases."""
    return (_figure(case, place) for place, case in enumerate(shown_cases(compared), 1))


def _figure(case: ShownCase, place: int) -> Figure:
    i, j = case.bodies
    return Figure(
        case.name,
        f"Case {place}: both bodies, cut through their centres",
        case.sentences[0],
        "Both bodies cut by a plane through their centres and the place of contact.",
        lambda form, drawn: draw_cut(case.section, drawn),
        (Key(f"body {i}", 0), Key(f"body {j}", 2)),
        labelled=False,
        file=f"cases/{case.name}.svg",
    )


SOURCE = FigureSource(_figures, section="cases")
