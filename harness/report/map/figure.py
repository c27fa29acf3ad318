"""The maps as a figure."""

from __future__ import annotations

from collections.abc import Sequence

from harness.report.drawing.cell_map import DrawnCell, Grid, draw_maps
from harness.report.figure import Figure, Key
from harness.report.map.answers import answers
from harness.report.map.cells import MethodMap
from harness.report.quantity import leaf_text
from harness.report.words import leaf_title, metric_title


def map_figure(maps: Sequence[MethodMap], name: str = "map") -> Figure:
    """All of these maps side by side, in one figure with one legend."""
    grids = [_grid(made) for made in maps]
    keys: dict[str, Key] = {}
    for made in maps:
        for answer in answers(made):
            if answer.style is not None:
                keys.setdefault(answer.letter, Key(f"{answer.letter}: {answer.method}", answer.style))
    described = " ".join(f"{made.title}: {_in_words(made)}" for made in maps)
    metric = metric_title(maps[0].metric)
    return Figure(
        name,
        f"The fastest method by {leaf_title(maps[0].x_leaf)} and {maps[0].y_leaf}",
        described,
        f"Each cell has the colour and the letter of the method with the least {metric} of those that are right "
        "there. Hatched: it cannot be told from another. Packing is the share of the box that bounding spheres fill. "
        "The table below says what each costs, and how far behind the next one is.",
        lambda form, name: draw_maps(grids, form, name),
        tuple(sorted(keys.values(), key=lambda key: key.style)),
        labelled=False,
    )


def _grid(made: MethodMap) -> Grid:
    cells = tuple(
        DrawnCell(
            made.xs.index(answer.cell.x),
            made.ys.index(answer.cell.y),
            answer.style,
            answer.letter,
            bool(answer.cell.doubt),
            answer.sentence,
        )
        for answer in answers(made)
        if answer.style is not None
    )
    return Grid(
        made.title,
        tuple(map(leaf_text, made.xs)),
        tuple(map(leaf_text, made.ys)),
        leaf_title(made.x_leaf),
        made.y_leaf,
        cells,
    )


def _in_words(made: MethodMap) -> str:
    return " ".join(f"{found.x}, {found.y}: {found.method}{_doubt(found.sure)}." for found in answers(made))


def _doubt(sure: str) -> str:
    return f" ({sure})" if sure.startswith("in doubt") else ""
