"""Axes: where a value lies on a drawing, round numbers, ticks, and texts cut to the room that they have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from harness.report.drawing import palette
from harness.report.drawing.canvas import Canvas
from harness.report.quantity import as_given, number, power_of_ten

Form = Literal["wide", "narrow", "card"]
"""Every drawing is made for desks and for phones: the lettering of one scaled to the other cannot be read."""

# px, how wide a drawing is.
WIDTHS: dict[Form, float] = {"wide": 1080.0, "narrow": 360.0, "card": 340.0}
FONT = 13.0  # px
CHARACTER = 7.0  # px, generous for a proportional font of that size


@dataclass(frozen=True)
class PanelFrame:
    """Where a panel lies, px from the bottom left, and what its edges mean."""

    left: float
    bottom: float
    right: float
    top: float
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    logarithmic_x: bool
    logarithmic_y: bool

    def x(self, value: float) -> float:
        """Place of a value of x, px."""
        return self.left + _share(value, self.x_range, self.logarithmic_x) * (self.right - self.left)

    def y(self, value: float) -> float:
        """Place of a value of y, px."""
        return self.bottom + _share(value, self.y_range, self.logarithmic_y) * (self.top - self.bottom)


def x_ticks(canvas: Canvas, frame: PanelFrame, ticks: Sequence[tuple[float, str]]) -> None:
    """Lines at these values of x, with their texts below the frame."""
    places = [frame.x(value) for value, _ in ticks]
    canvas.line(
        [value for x in places for value in (x, x, math.nan)],
        [value for _ in places for value in (frame.bottom, frame.top, math.nan)],
        palette.GRID,
        1.0,
    )
    for x, (_, text) in zip(places, ticks, strict=True):
        canvas.text(x, frame.bottom - canvas.font - 5, text, horizontal="center")


def y_ticks(canvas: Canvas, frame: PanelFrame, most: int) -> None:
    """Lines at round numbers of y, no more than so many, with their texts to the left of the frame."""
    ticks = round_numbers(frame.y_range, frame.logarithmic_y, most)
    places = [frame.y(value) for value in ticks]
    canvas.line(
        [value for _ in places for value in (frame.left, frame.right, math.nan)],
        [value for y in places for value in (y, y, math.nan)],
        palette.GRID,
        1.0,
    )
    for y, value in zip(places, ticks, strict=True):
        canvas.text(frame.left - 7, y, tick_text(value), horizontal="right", vertical="center")


def round_numbers(bounds: tuple[float, float], logarithmic: bool, most: int) -> list[float]:
    """Round numbers within bounds: 1, 2, 5 of every power of ten, or fewer of each where that is too many."""
    low, high = bounds
    if not logarithmic:
        return even_numbers(low, high, most - 1)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    inside: list[float] = []
    for steps in ((1, 2, 5), (1, 3), (1,)):
        values = [float(f"{step}e{power}") for power in powers for step in steps]
        inside = [value for value in values if low <= value <= high]
        if len(inside) <= most:
            return inside
    return inside[:: math.ceil(len(inside) / most)]


_EDGE = 1e-9
"""Of a step: a number that is no farther outside of the bounds lies on one, but for rounding."""


def even_numbers(low: float, high: float, most: int, steps: Sequence[float] = (1, 2, 2.5, 5)) -> list[float]:
    """The multiples within bounds of a round step, as matplotlib's `MaxNLocator` chooses it.

    It is the smallest of these steps, times powers of ten, that makes no more than so many intervals; or a smaller one,
    where that leaves less than two numbers.

    >>> even_numbers(0.3, 9.0, 6), even_numbers(-0.12, 1.18, 7, (1, 2, 5))
    ([2.0, 4.0, 6.0, 8.0], [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0])
    """
    if not high > low:
        return [low]
    power = math.floor(math.log10((high - low) / most))
    ordered = [float(f"{step}e{power + further}") for further in (-1, 0, 1) for step in steps]
    enough = next(place for place, step in enumerate(ordered) if step >= (high - low) / most)
    found: list[float] = []
    for step in ordered[enough::-1]:
        first, last = math.ceil(low / step - _EDGE), math.floor(high / step + _EDGE)
        found = [place * step for place in range(first, last + 1)]
        if len(found) > 1:
            break
    return found


def tick_text(value: float) -> str:
    """A round number of an axis, without the zeros that three significant digits would add; far from 1, its power."""
    if value > 0.0 and not 1e-3 <= value < 1e6 and math.isclose(power := math.log10(value), round(power)):
        return power_of_ten(round(power))
    return number(value) if value.is_integer() else as_given(value, 4)


def shorten(text: str, characters: float) -> str:
    """The text, or its beginning and an ellipsis where it is longer than that."""
    keep = max(2, int(characters))
    return text if len(text) <= keep else f"{text[: keep - 1]}…"


def _share(value: float, bounds: tuple[float, float], logarithmic: bool) -> float:
    """Where a value lies between two bounds, 0 to 1."""
    low, high = bounds
    if logarithmic:
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)
