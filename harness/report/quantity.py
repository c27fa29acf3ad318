"""Numbers as people read them: three significant digits, one unit a column, thin spaces between thousands."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from statistics import median

import numpy as np

THIN = "\u202f"  # narrow no-break space
MISSING = "–"
_PREFIXES = {
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")),
    "B": ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1.0, "B")),
    "B/s": ((1e9, "GB/s"), (1e6, "MB/s"), (1e3, "kB/s"), (1.0, "B/s")),
}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """A unit with its prefix: the same for every number of a column or an axis, so that they can be compared."""

    factor: float
    symbol: str

    def text(self, value: float | None) -> str:
        """The number alone; the unit stands in the heading."""
        return MISSING if value is None else number(value / self.factor)

    def with_unit(self, value: float | None) -> str:
        """The number and its unit."""
        if value is None or not math.isfinite(value):
            return MISSING
        return f"{self.text(value)}\u00a0{self.symbol}" if self.symbol else self.text(value)

    def margin(self, value: float, half: float) -> str:
        """Half an interval, with as many decimals as the value beside it."""
        decimals = _decimals(value / self.factor)
        return f"{half / self.factor:,.{decimals}f}".replace(",", THIN)


def scale(values: Iterable[float], unit: str) -> Scale:
    """The prefix under which the middle one of these values reads best.

    Parameters
    ----------
    values : numbers in the unit; not finite ones and zeros do not count
    unit : "s", "B" and "B/s" take prefixes, "1" means a plain number
    """
    if unit not in _PREFIXES:
        return Scale(1.0, "" if unit == "1" else unit)
    sizes = [abs(value) for value in values if math.isfinite(value) and value != 0.0]
    middle = median(sizes) if sizes else 1.0
    for factor, symbol in _PREFIXES[unit]:
        if middle >= factor * 0.9995:
            return Scale(factor, symbol)
    return Scale(*_PREFIXES[unit][-1])


def quantity(value: float | None, unit: str) -> str:
    """One number with the unit that suits it alone.

    >>> quantity(0.00345, "s").replace("\u00a0", " ")
    '3.45 ms'
    """
    if value is None or not math.isfinite(value):
        return MISSING
    return scale([value], unit).with_unit(value)


def number(value: float | None) -> str:
    """Whole numbers in full, others to three significant digits, powers of ten only far from 1.

    >>> number(1234.5).replace(THIN, " "), number(0.012345), number(1e-9).replace(THIN, " ")
    ('1 234', '0.0123', '1.00 × 10⁻⁹')
    """
    if value is None or math.isnan(value):
        return MISSING
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    size = abs(value)
    if size >= 1e15 or 0.0 < size < 1e-4:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{_signed(mantissa)}{THIN}×{THIN}{power_of_ten(int(exponent))}"
    if float(value).is_integer():
        return _signed(f"{int(value):,}".replace(",", THIN))
    return _signed(f"{value:,.{_decimals(value)}f}".replace(",", THIN))


def as_given(value: float, digits: int = 6) -> str:
    """A number as somebody set it, without zeros at its end: 10⁻⁶ where a measured one would be 1.00 × 10⁻⁶.

    >>> as_given(0.25), as_given(1e-6), as_given(-2.5e-7).replace(THIN, " ")
    ('0.25', '10⁻⁶', '−2.5 × 10⁻⁷')
    """
    mantissa, far, exponent = f"{value:.{digits}g}".partition("e")
    if not far:
        return _signed(mantissa)
    power = power_of_ten(int(exponent))
    if mantissa in ("1", "-1"):
        return _signed(mantissa[:-1]) + power
    return f"{_signed(mantissa)}{THIN}×{THIN}{power}"


def power_of_ten(exponent: int) -> str:
    """10⁻⁴ for -4."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def plural(count: int, noun: str, nouns: str | None = None) -> str:
    """A count and its noun: "1 run", "50 runs", and of an odd one "2 bodies"."""
    return f"{number(count)}\u00a0{noun if count == 1 else nouns or noun + 's'}"


def exponent_text(value: float) -> str:
    """An exponent to two decimals."""
    return _signed(f"{value:.2f}") if abs(value) >= 0.005 else "0.00"


def leaf_text(value: object) -> str:
    """A leaf's value as its author would write it: 1/60 stays 1/60, a distribution a distribution.

    >>> leaf_text(1 / 60), leaf_text({"uniform": [0.5, 1.5]}), leaf_text(None)
    ('1/60', 'uniform 0.5 to 1.5', 'none')
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "none"
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | float | np.number):
        return _fraction(float(value))
    if isinstance(value, dict):
        return ", ".join(f"{key} {_inner(key, inner)}" for key, inner in value.items()) or "as planned"
    if isinstance(value, list | tuple):
        if value and all(isinstance(item, dict) for item in value):
            return f"{plural(len(value), 'body', 'bodies')} given one by one"
        return " × ".join(map(leaf_text, value)) if len(value) <= 3 else json.dumps(list(value))
    return str(value)


def _inner(key: str, value: object) -> str:
    """What stands in a mapping: the bounds or choices of a distribution, whether a stage is forced on, or a value."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, list | tuple):
        return (" to " if key == "uniform" else ", ").join(map(leaf_text, value))
    return leaf_text(value)


def _fraction(value: float) -> str:
    if 0.0 < value < 1.0:
        near = Fraction(value).limit_denominator(1000)
        # 0.5 and 0.05 are better as decimals; 1/60 has none
        if near.numerator == 1 and math.isclose(float(near), value, rel_tol=1e-12) and len(f"{value:.12g}") > 5:
            return f"1/{near.denominator}"
    return number(value) if value.is_integer() else as_given(value)


def _decimals(value: float) -> int:
    """Decimals that leave three significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return 0
    return min(9, max(0, 2 - int(f"{value:.2e}".partition("e")[2])))


def _signed(text: str) -> str:
    return text.replace("-", "−")
