"""What a report shows of an experiment: the axes of its figure, and numbers published elsewhere beside ours."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from harness.experiment.leaves import LeafName
from harness.experiment.messages import shown
from harness.experiment.number import finite, wrong
from harness.experiment.schema import Declared, Text


def _cell(value: Any) -> float | str:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise wrong(f"must be a number or text, not {shown(value)}")
    return value if isinstance(value, str) else finite(value)


def _as_list(value: Any) -> Any:
    if not isinstance(value, str | list | tuple):
        raise wrong(f"must be the name of a metric or a list of names, not {shown(value)}")
    return [value] if isinstance(value, str) else value


class Published(Declared):
    """Numbers from elsewhere."""

    source: Text = Field(description="who published them, and where")
    note: Text | None = Field(None, description="what a reader should know about them")
    rows: tuple[dict[str, Annotated[float | str, BeforeValidator(_cell)]], ...] = Field(
        (), description="leaf values that say which point is meant, and metrics with the published numbers"
    )


class MapSpec(Declared):
    """Two leaves over which a map shows the fastest method."""

    x: LeafName = Field(description="leaf or derived parameter from left to right")
    y: LeafName = Field(description="leaf or derived parameter from bottom to top")


class ReportSpec(Declared):
    """The axes of the figure."""

    x: LeafName | None = Field(None, description="leaf or derived parameter along the figure")
    y: Annotated[tuple[Text, ...], BeforeValidator(_as_list)] = Field((), description="metrics up the figure")
    map: MapSpec | None = Field(None, description="map of the fastest method over two leaves, by the first metric of y")
