"""Values of options that several commands take."""

from __future__ import annotations

import argparse
import math


def positive_count(text: str) -> int:
    """A whole number of 1 or more."""
    number = int(text) if text.strip().isdecimal() else 0
    if number < 1:
        raise argparse.ArgumentTypeError("it must be a whole number, 1 or more")
    return number


def positive_seconds(text: str) -> float:
    """A time above 0, or a fraction such as 1/60."""
    above, slash, below = text.partition("/")
    try:
        time = float(above) / float(below) if slash else float(text)
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(f"no number: {text!r}") from None
    if not 0.0 < time < math.inf:
        raise argparse.ArgumentTypeError(f"a time must be above 0 and finite, not {text}")
    return time


def comma_separated(text: str) -> list[str]:
    """Names, with commas between them."""
    return [name.strip() for name in text.split(",") if name.strip()]
