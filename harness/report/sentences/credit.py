"""Who did the work: which pairs our kernels settled, and which were put to the library that a method names."""

from __future__ import annotations

import math
from collections.abc import Sequence

from markupsafe import Markup

from harness.report.point import MeasuredPoint
from harness.report.quantity import number
from harness.report.series import Arrangement
from harness.report.words import is_noisy
from harness.vocabulary import MethodName


def credit_sentences(arrangement: Arrangement) -> list[Markup]:
    """A sentence for each method whose kernels settle pairs that its library would be asked about otherwise."""
    points: dict[MethodName, list[MeasuredPoint]] = {}
    for point in arrangement.points:
        method = MethodName.of(point.parameters)
        if method.kernels and not point.good.empty:
            points.setdefault(method, []).append(point)
    several = len({method.shape for method in points}) > 1
    sentences = [_sentence(method, f", {method.shape}," if several else "", found) for method, found in points.items()]
    return [sentence for sentence in (*sentences, _walls(arrangement)) if sentence]


def _walls(arrangement: Arrangement) -> Markup:
    """Of a clock of walls that is shown of several methods: it is no library's."""
    shown = [name for name in arrangement.metrics if name.startswith("box_") and is_noisy(name)]
    methods = {MethodName.of(point.parameters) for point in arrangement.points if not point.good.empty}
    if len(methods) < 2 or not any((point.values(name) > 0.0).any() for point in arrangement.points for name in shown):
        return Markup()
    return Markup("Walls are tested by kernels of this program, whatever finds the pairs.")


def _sentence(method: MethodName, shape: str, points: Sequence[MeasuredPoint]) -> Markup:
    """What it put to its library; empty where it may have put more than was counted."""
    counts = [(point.median("fcl_tests"), point.median("narrow_tests")) for point in points]
    put = [(asked, tests) for asked, tests in counts if not math.isnan(asked)]  # where it was counted
    if not put and method.stepped and method.shape != "sphere":
        return Markup()
    if not put:
        return Markup("<strong>{}</strong>{} is kernels of this program alone: it asks {} nothing.").format(
            method.label, shape, method.backend
        )
    asked, tests = zip(*put, strict=True)
    return Markup("<strong>{}</strong>{} put {} of {} pairs to {}; kernels of this program settled the others.").format(
        method.label, shape, _range(asked), _range(tests), method.backend
    )


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return number(low) if low == high else f"{number(low)} to {number(high)}"
