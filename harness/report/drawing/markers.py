"""The outlines of markers as paths of SVG around (0, 0), as large as matplotlib draws those of these names."""

from __future__ import annotations

import math
from functools import cache


def px(value: float) -> str:
    """A length in a drawing: hundredths of px are enough.

    >>> px(12.0), px(0.125), px(-0.001)
    ('12', '0.12', '0')
    """
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


@cache
def outline(marker: str, radius: float) -> str:
    """A marker as the data of a path.

    Parameters
    ----------
    marker : "o" a disc, "s" a square, "D" a diamond, "^" and "v" triangles, "P" a plus, "X" a cross, "p" a pentagon,
        "|" a stroke
    radius : px, half of its size
    """
    if marker == "o":
        across = px(2.0 * radius)
        arc = f"a{px(radius)} {px(radius)} 0 1 0"
        return f"M{px(-radius)} 0{arc} {across} 0{arc} -{across} 0z"
    end = "" if marker == "|" else "z"
    return "M" + "L".join(f"{px(x * radius)} {px(y * radius)}" for x, y in _corners(marker)) + end


def _corners(marker: str) -> list[tuple[float, float]]:
    """Right and down, of a marker of radius 1."""
    if marker == "D":
        far = math.sqrt(2.0)
        return [(0.0, far), (far, 0.0), (0.0, -far), (-far, 0.0)]
    if marker == "p":
        turns = [math.tau * place / 5.0 for place in range(5)]
        return [(-math.sin(turn), -math.cos(turn)) for turn in turns]
    if marker in ("P", "X"):
        third = 1.0 / 3.0
        arm = [(-third, 1.0), (third, 1.0), (third, third)] if marker == "P" else [(-0.5, 1.0), (0.0, 0.5), (0.5, 1.0)]
        found = []
        for _ in range(4):  # each arm is the one before, turned by a quarter
            found += arm
            arm = [(y, -x) for x, y in arm]
        return found
    return {
        "s": [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)],
        "^": [(0.0, -1.0), (-1.0, 1.0), (1.0, 1.0)],
        "v": [(0.0, 1.0), (1.0, -1.0), (-1.0, -1.0)],
        "|": [(0.0, 1.0), (0.0, -1.0)],
    }[marker]
