"""Engines against families of a truth set: the share of answers that are not right, and whether they are unsafe."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from harness.report.drawing.rates import draw_rates
from harness.report.figure import Figure, FigureSource, Key, figure_name
from harness.report.quantity import number
from harness.report.truth import ALL, OTHERS, UNSAFE, TruthPart, TruthResults

SAFE_STYLE, UNSAFE_STYLE = 0, 2


def _figures(asked: TruthResults) -> Iterator[Figure]:
    return (_figure(part) for part in asked.parts)


def _figure(part: TruthPart) -> Figure:
    cells = {
        (engine, family): found
        for engine in part.engines
        for family in part.families
        if (found := part.count(engine, family)) is not None
    }
    told = [
        f"{engine}: {number(found['right'])} of {number(found['asked'])} right"
        for engine in part.engines
        if (found := part.count(engine, ALL)) is not None
    ]
    name = figure_name("truth", part.name)
    return Figure(
        name,
        f"Answers that are not right, {part.name}",
        f"{len(part.engines)} engines on {len(part.families)} families. {'; '.join(told)}.",
        "Each mark is an engine on a family of cases: the larger, the more of its answers are not right, in %. A line "
        "stands for none. “dt” is the step of a collision test that is asked frame by frame.",
        lambda form, drawn: draw_rates(
            list(map(part.heading, part.engines)),
            part.families,
            {(part.heading(engine), family): _rate(found) for (engine, family), found in cells.items()},
            form,
            drawn,
        ),
        (Key("early or failed", SAFE_STYLE), Key("some missed, late or false", UNSAFE_STYLE)),
        labelled=False,
        file=f"{name}.svg",
    )


def _rate(found: Mapping[str, Any]) -> tuple[float, int]:
    """Answers that are not right, in %, and the style of their mark."""
    unsafe, others = (sum(found[kind] for kind in kinds) for kinds in (UNSAFE, OTHERS))
    return 100.0 * (unsafe + others) / found["asked"], UNSAFE_STYLE if unsafe else SAFE_STYLE


SOURCE = FigureSource(_figures, section="matrix")
