"""The kinds of numbers an experiment holds, as pydantic types: read strictly, refused in sentences."""

from __future__ import annotations

import math
import numbers
import re
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, StrictBool, WithJsonSchema
from pydantic_core import PydanticCustomError

from harness.experiment.messages import shown

# Beyond these, squares and cubes of lengths and speeds would overflow or underflow.
SMALLEST, LARGEST = 1e-30, 1e30

_UNITS = {"": 1, "b": 1} | {
    f"{prefix}{unit}": base**power
    for power, prefix in enumerate("kmgt", start=1)
    for unit, base in (("b", 1000), ("ib", 1024))
}
_BYTES = re.compile(r"([0-9]+(?:\.[0-9]+)?) *([A-Za-z]*)")
BYTES_PATTERN = r"^[0-9]+(\.[0-9]+)? *([kKmMgGtT]?[iI]?[bB])?$"


def wrong(message: str) -> PydanticCustomError:
    """An error for a validator to raise, whose message is shown word for word."""
    return PydanticCustomError("sentence", "{message}", {"message": message})


def finite(value: Any) -> float:
    """A number that is neither infinite nor NaN, in floating point.

    >>> finite(3)
    3.0
    >>> finite("3")
    Traceback (most recent call last):
    pydantic_core._pydantic_core.PydanticCustomError: must be a number, not "3"
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise wrong(f"must be a number, not {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise wrong(f"must be a finite number, not {shown(value)}")
    return number


def _moderate(value: Any) -> float:
    number = finite(value)
    if number != 0 and not SMALLEST <= abs(number) <= LARGEST:
        raise wrong(f"must be 0 or between {SMALLEST:g} and {LARGEST:g} in magnitude, not {shown(value)}")
    return number


def _whole(value: Any) -> int:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        raise wrong(f"must be a whole number, not {shown(value)}")
    return int(value)


def holding(count: int, what: str) -> BeforeValidator:
    """A validator that refuses a list of any other length in one sentence."""

    def check(value: Any) -> Any:
        if isinstance(value, list | tuple) and len(value) != count:
            raise wrong(f"must hold {what}, not {len(value)} value{'' if len(value) == 1 else 's'}")
        return value

    return BeforeValidator(check)


def rising(bounds: tuple[float, float]) -> tuple[float, float]:
    """The bounds, if the low one is the first.

    >>> rising((0.5, 1.5))
    (0.5, 1.5)
    >>> rising((1.5, 0.5))
    Traceback (most recent call last):
    pydantic_core._pydantic_core.PydanticCustomError: must rise from low to high, not fall from 1.5 to 0.5
    """
    if bounds[0] > bounds[1]:
        raise wrong(f"must rise from low to high, not fall from {shown(bounds[0])} to {shown(bounds[1])}")
    return bounds


def _bytes(value: Any) -> int:
    number: float
    if isinstance(value, str) and (parts := _BYTES.fullmatch(value.strip()[:40])) and parts[2].lower() in _UNITS:
        number = float(parts[1]) * _UNITS[parts[2].lower()]
    elif isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise wrong(f"must be a number of bytes such as 4GiB or 512 MiB, not {shown(value)}")
    else:
        number = _whole(value)
    if not 1 <= number <= 1e15:
        raise wrong(f"must be at least 1 byte and at most 1 PB, not {shown(value)}")
    return int(number)


# Any finite number.
Finite = Annotated[float, BeforeValidator(finite)]
# A finite number that physics can be done with in floats.
Number = Annotated[float, BeforeValidator(_moderate)]
# A whole number, also written as 1e5.
Whole = Annotated[int, BeforeValidator(_whole)]
# A point or vector in space.
Vector = Annotated[tuple[Number, Number, Number], holding(3, "3 numbers")]
# A low and a high number.
Bounds = Annotated[tuple[Finite, Finite], holding(2, "a low and a high value"), AfterValidator(rising)]
# An amount of memory in bytes.
Bytes = Annotated[
    int,
    BeforeValidator(_bytes),
    WithJsonSchema({"anyOf": [{"type": "integer", "minimum": 1}, {"type": "string", "pattern": BYTES_PATTERN}]}),
]
Switch = StrictBool
