"""A table as the templates write it: columns, and entries that know how they are shown and sorted."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Any

from harness.measure.statistics import Summary
from harness.report.point import MeasuredPoint
from harness.report.quantity import MISSING, Scale, number

_PLAIN = re.compile(r"−?[\d\u202f]+(\.\d+)?×?")


@dataclass(frozen=True)
class Column:
    """A heading with its unit; numbers stand to the right."""

    title: str
    unit: str = ""
    numeric: bool = True


@dataclass(frozen=True)
class ColumnGroup:
    """A heading above several columns; without a title, a gap."""

    title: str
    span: int


@dataclass(frozen=True)
class Entry:
    """One entry: text, a margin in small print, and how it is marked.

    Parameters
    ----------
    style : series whose marker stands before the text
    mark : classes of the style sheet, such as "best" or "t3"
    flag : a warning behind the text
    sort : what the column is sorted by, where it is not the text
    """

    text: str
    small: str = ""
    style: int | None = None
    numeric: bool = True
    mark: str = ""
    struck: bool = False
    flag: str = ""
    sort: float | None = None

    @property
    def sorted_by(self) -> float | None:
        """What the page must say for the column to be sorted; nothing where the text is the number itself."""
        return None if _PLAIN.fullmatch(self.text) else self.sort

    @property
    def classes(self) -> str:
        """The classes of the entry's element."""
        return " ".join(name for name in ("n" if self.numeric else "", self.mark) if name)


@dataclass(frozen=True)
class Table:
    """Rows of entries; the first entry of a row is its heading."""

    name: str
    note: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Entry, ...], ...]
    groups: tuple[ColumnGroup, ...] = ()


def words(text: str, style: int | None = None, flag: str = "") -> Entry:
    """An entry of text."""
    return Entry(text, style=style, numeric=False, flag=flag)


def measured(point: MeasuredPoint | None, metric: str, unit: Scale, mark: str = "", flag: str = "") -> Entry:
    """Median and half its interval, ° where a repeat is an outlier; where no run came to its end, why not."""
    found = point.summary(metric) if point else None
    if found is None:
        return failure(point)
    struck = point is not None and point.is_wrong
    return replace(measured_summary(found, unit), mark=mark, struck=struck, flag=flag)


def measured_summary(found: Summary | None, unit: Scale) -> Entry:
    """The same of a summary alone."""
    if found is None:
        return Entry(MISSING)
    half = (found.high - found.low) / 2
    small = f"±{unit.margin(found.median, half)}" if half > 0 else ""
    if found.outliers and half > 0:
        small += "°"
    return Entry(unit.text(found.median), small, sort=plain(found.median))


def failure(point: MeasuredPoint | None) -> Entry:
    """What stands where a number should: how the runs ended, or that there is none."""
    if point is None or not point.statuses:
        return Entry(MISSING if point is None else "not run")
    ended = sorted(point.statuses - {"ok"})
    return Entry("", flag=", ".join(ended)) if ended else Entry(MISSING)


def plain(value: Any) -> float | None:
    """A number to sort by; six digits are enough for that, and keep pages small."""
    return float(f"{value:.6g}") if isinstance(value, int | float) and math.isfinite(value) else None


def counted(value: float) -> Entry:
    """A plain number."""
    return Entry(number(value), sort=plain(value))


def counted_bad(value: float) -> Entry:
    """A count of what should not be: flagged unless it is 0."""
    return Entry("", flag=number(value), sort=plain(value)) if value else counted(value)
