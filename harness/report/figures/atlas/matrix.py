"""Engines against families of poses: how often each is wrong, and whether by more than it says of itself."""

from __future__ import annotations

from collections.abc import Iterator

from harness.report.atlas import AtlasPart, AtlasResults
from harness.report.drawing.rates import draw_rates
from harness.report.figure import Figure, FigureSource, Key, figure_name
from harness.report.quantity import number

WITHIN, BEYOND = 0, 2
"""The styles of wrong verdicts that lie within the tolerance that the engine declares, and beyond it."""


def _figures(atlas: AtlasResults) -> Iterator[Figure]:
    return (matrix_figure(part) for part in atlas.parts)


def matrix_figure(part: AtlasPart) -> Figure:
    """The matrix of one shape of one mesh."""
    name = figure_name("atlas", part.experiment, part.title)
    beyond = [
        f"{engine} in {number(cell['beyond'])} of {number(cell['verdicts'])} ({family})"
        for (engine, family), cell in sorted(part.cells.items())
        if cell["beyond"]
    ]
    told = f"Wrong beyond their tolerance: {'; '.join(beyond)}." if beyond else "None is wrong beyond its tolerance."
    return Figure(
        name,
        f"Wrong verdicts, {part.title}",
        f"{len(part.engines)} engines on {len(part.families)} families of poses. {told}",
        "Each mark is an engine on a family of poses: the larger, the more wrong verdicts in a million, of which the "
        "table has the intervals. A line stands for none among those asked.",
        lambda form, drawn: draw_rates(
            part.engines,
            part.families,
            {
                place: (cell["per_million"] or 0.0, BEYOND if cell["beyond"] else WITHIN)
                for place, cell in part.cells.items()
            },
            form,
            drawn,
        ),
        (Key("within the tolerance that the engine declares", WITHIN), Key("some beyond it", BEYOND)),
        labelled=False,
        file=f"{name}.svg",
    )


SOURCE = FigureSource(_figures, section="matrix")
