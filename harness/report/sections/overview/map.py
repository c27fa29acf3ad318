"""Which method where: the maps, a form that finds the nearest cell, and all cells as a table."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.map.answers import answers
from harness.report.markup import render
from harness.report.overview import Overview
from harness.report.quantity import leaf_text
from harness.report.section import Section
from harness.report.words import leaf_title


def _html(overview: Overview) -> Markup:
    maps, figure = overview.maps, overview.map_figure
    if figure is None:
        return Markup()
    shapes = {"sphere": "spheres", "hull": "convex", "mesh": "concave"}
    accuracies = sorted({made.accuracy for made in maps}, reverse=True)
    return render(
        "overview/map.html.j2",
        figure=figure,
        answers=[answer for made in maps for answer in answers(made)],
        x=leaf_title(maps[0].x_leaf),
        y="packing, of 1" if maps[0].y_leaf == "packing" else leaf_title(maps[0].y_leaf),
        shapes=[(shape, shapes.get(shape, shape)) for shape in dict.fromkeys(made.shape for made in maps)],
        queries=list(dict.fromkeys(made.query for made in maps)),
        accuracies=[(value, leaf_text(value) if value else "exact") for value in accuracies],
    )


SECTION = Section("map", "", 0, _html)
