"""What scenes, knobs, errors and ratios are called beside curves of error against run time."""

from __future__ import annotations

import math

from harness.report.accuracy.error_kind import GAPS
from harness.report.accuracy.tradeoffs import MOST_WRONG, Curve, Setting, Tradeoff
from harness.report.quantity import leaf_text, number, power_of_ten, quantity
from harness.report.words import scene_text

WRONG_TEXT = f"{100 * MOST_WRONG:g} %"
"""The share of hits that a method may get wrong and still count."""


def scene_of(tradeoff: Tradeoff) -> str:
    """The scene in a phrase."""
    first = dict(tradeoff.curves[0].settings[0].point.parameters)
    shapes = {s.point.parameters.get("shape") for _, s in tradeoff.settings}
    first["shape"] = next((shape for shape in ("mesh", "hull", "sphere") if shape in shapes), None)
    if first.get("count") is None and isinstance(first.get("bodies"), list):
        first["count"] = len(first["bodies"])
    if tradeoff.kind is not GAPS:
        first["query"] = None  # times of hits are told by several queries
    return ", ".join(part for part in (scene_text(first), tradeoff.place) if part)


def knob_text(curve: Curve, setting: Setting) -> str:
    """The setting in brackets, where the method has several."""
    several = curve.knob and len({found.knob for found in curve.settings}) > 1
    return f" ({curve.knob} {leaf_text(setting.knob)})" if several else ""


def target_text(target: float, unit: str) -> str:
    """An error to be reached: "10⁻⁴ s"."""
    return f"{power_of_ten(round(math.log10(target)))}\u00a0{unit}"


def time_text(value: float) -> str:
    """A time; below what any clock resolves it stays in seconds."""
    return quantity(value, "s") if value >= 1e-9 or value == 0.0 else f"{number(value)}\u00a0s"


def error_text(value: float, unit: str) -> str:
    """An error in its unit."""
    return time_text(value) if unit == "s" else f"{number(value)}\u00a0{unit}"
