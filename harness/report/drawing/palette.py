"""Colours and marker shapes of the series, and how one drawing follows light and dark pages.

Figures are drawn in colours that mean nothing (sentinels). On a page each is replaced by a CSS variable, which the
style sheet gives a light and a dark value; in a file of its own, by the light value.
"""

from __future__ import annotations

# Apart from one another under simulated colour blindness, the first six most, and dark enough against their background.
LIGHT = (
    *("#1798fa", "#c98704", "#a8002b", "#6a0a70", "#9b8ea3", "#4100c3"),
    *("#ed5d51", "#5d5bf8", "#9a57b1", "#b24068", "#520693"),
)
DARK = (
    *("#69b1fc", "#ffa223", "#ee5a60", "#bc9eb6", "#c6f9d0", "#8664ff"),
    *("#e30606", "#346c74", "#38f1fe", "#844daa", "#e9ee80"),
)
# Eight shapes against eleven colours: 88 series before a pair of both comes back.
MARKERS = ("o", "s", "D", "^", "v", "P", "X", "p")

SERIES = tuple(f"#0102f{place:x}" for place in range(len(LIGHT)))
INK, SOFT, GRID, PAGE = "#010203", "#010204", "#010205", "#010206"

_VARIABLES = {
    **{sentinel: f"var(--s{place})" for place, sentinel in enumerate(SERIES)},
    INK: "var(--ink)",
    SOFT: "var(--soft)",
    GRID: "var(--rule)",
    PAGE: "var(--page)",
}
_FIXED = {
    **dict(zip(SERIES, LIGHT, strict=True)),
    INK: "#1b1c28",
    SOFT: "#5a6070",
    GRID: "#e1e4ea",
    PAGE: "#ffffff",
}

# The markers as paths around (0, 0), radius about 5, for the keys in tables and legends.
OUTLINES = {
    "o": "M-4.6 0a4.6 4.6 0 1 0 9.2 0a4.6 4.6 0 1 0-9.2 0z",
    "s": "M-4.2-4.2h8.4v8.4h-8.4z",
    "D": "M0-5.6 5.6 0 0 5.6-5.6 0z",
    "^": "M0-5 5.2 4.2h-10.4z",
    "v": "M0 5 5.2-4.2h-10.4z",
    "P": "M-1.7-5h3.4v3.3h3.3v3.4h-3.3v3.3h-3.4v-3.3h-3.3v-3.4h3.3z",
    "X": "M-4.7-2.4-2.4-4.7 0-2.3 2.4-4.7 4.7-2.4 2.3 0 4.7 2.4 2.4 4.7 0 2.3-2.4 4.7-4.7 2.4-2.3 0z",
    "p": "M0-5.2 4.9-1.6 3.1 4.2h-6.2l-1.8-5.8z",
}


def colour(style: int) -> str:
    """The sentinel colour of a series."""
    return SERIES[style % len(SERIES)]


def marker(style: int) -> str:
    """The marker of a series, as matplotlib names it."""
    return MARKERS[style % len(MARKERS)]


def themed(svg: str) -> str:
    """The drawing in CSS variables, for a page."""
    return _replace(svg, _VARIABLES)


def fixed(svg: str) -> str:
    """The drawing in light colours, for a file."""
    return _replace(svg, _FIXED)


def light(colour: str) -> str:
    """A colour of a drawing in the light value of its sentinel; any other as it is."""
    return _FIXED.get(colour, colour)


def variables(dark: bool) -> str:
    """The series colours as CSS declarations."""
    colours = DARK if dark else LIGHT
    return " ".join(f"--s{place}: {value};" for place, value in enumerate(colours))


def _replace(svg: str, colours: dict[str, str]) -> str:
    for sentinel, value in colours.items():
        svg = svg.replace(sentinel, value)
    return svg
