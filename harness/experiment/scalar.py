"""Plain YAML text (unquoted) into a value: numbers as people write them, fractions among them, and on and off.

YAML's own rules are not used: they read `1e-6` as text, `1:30` as a number in base 60 and `010` as eight.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction

# Longer text is text: this bounds the time that matching and converting can take.
LONGEST_NUMBER = 400

DECIMAL = r"(?:[0-9][0-9_]*(?:\.[0-9_]*)?|\.[0-9][0-9_]*)"
FLOAT = rf"[-+]?{DECIMAL}(?:[eE][-+]?[0-9]+)?"
FRACTION = rf"([-+]?{DECIMAL})\s*/\s*({DECIMAL})"

_INT = re.compile(r"[-+]?[0-9][0-9_]*")
_FLOAT = re.compile(FLOAT)
_FRACTION = re.compile(FRACTION)
_WORDS: dict[str, bool | float | None] = {
    "": None,
    "~": None,
    "null": None,
    "true": True,
    "yes": True,
    "on": True,
    "false": False,
    "no": False,
    "off": False,
    ".inf": math.inf,
    "+.inf": math.inf,
    "-.inf": -math.inf,
    ".nan": math.nan,
}
# As in YAML: a word counts in lower case, Capitalised or in UPPER CASE.
WORDS = {spelling: value for word, value in _WORDS.items() for spelling in (word, word.capitalize(), word.upper())}


def resolve(text: str) -> str | int | float | bool | None:
    """The value of a plain scalar.

    >>> resolve("1/4"), resolve("1e-6"), resolve("1_000"), resolve("off"), resolve("1:30")
    (0.25, 1e-06, 1000, False, '1:30')

    Raises
    ------
    ValueError
        For a fraction with a zero below the line.
    """
    if text in WORDS:
        return WORDS[text]
    if len(text) > LONGEST_NUMBER:
        return text
    if _INT.fullmatch(text):
        return int(text.replace("_", ""))
    if _FLOAT.fullmatch(text):
        return float(text.replace("_", ""))
    if parts := _FRACTION.fullmatch(text):
        return _divide(parts[1].replace("_", ""), parts[2].replace("_", ""), text)
    return text


def _divide(above: str, below: str, text: str) -> float:
    divisor = Fraction(below.rstrip("."))
    if divisor == 0:
        raise ValueError(f"{text} divides by zero")
    try:
        return float(Fraction(above.rstrip(".")) / divisor)
    except OverflowError:
        return math.inf
