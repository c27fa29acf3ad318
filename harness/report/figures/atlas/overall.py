"""Engines against families of poses, of all bodies together."""

from __future__ import annotations

from collections.abc import Iterator

from harness.report.atlas import AtlasResults
from harness.report.figure import Figure, FigureSource
from harness.report.figures.atlas.matrix import matrix_figure


def _figures(atlas: AtlasResults) -> Iterator[Figure]:
    return (matrix_figure(part) for part in atlas.overall)


SOURCE = FigureSource(_figures, section="overall")
