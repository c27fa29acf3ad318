"""Work-precision diagrams: error against CPU time, a curve a method, with the front that nothing beats."""

from __future__ import annotations

from harness.report.accuracy.experiment import ExperimentAccuracy
from harness.report.accuracy.texts import WRONG_TEXT, error_text, scene_of
from harness.report.accuracy.tradeoffs import Curve, Tradeoff
from harness.report.drawing.panels import Line, Panel, draw_panels
from harness.report.figure import Figure, FigureSource, Key
from harness.report.quantity import Scale, quantity, scale


def _figures(accuracy: ExperimentAccuracy) -> list[Figure]:
    """A diagram a scene."""
    return [_figure(found, f"{accuracy.identity}-{place}") for place, found in enumerate(accuracy.scenes)]


def _figure(tradeoff: Tradeoff, name: str) -> Figure:
    """Error against CPU time, a curve a method, with the front that nothing beats."""
    kind = tradeoff.kind
    unit = scale([found.cost.median for _, found in tradeoff.settings], "s")
    lines = tuple(_line(curve, unit) for curve in tradeoff.curves)
    # an error of exactly 0, where nothing is known of the reference, has no place on a logarithmic axis
    front = tuple((found.cost.median / unit.factor, found.shown) for found in tradeoff.front if found.shown > 0)
    axes = f"CPU time, {unit.symbol}", f"{kind.typical} error of {kind.of}, {kind.unit}"
    panel = Panel(
        "", *axes, lines, logarithmic=True, front=front, rounded=True,
    )  # fmt: skip
    scene = scene_of(tradeoff)
    sentences = " ".join(_in_words(curve) for curve in tradeoff.curves)
    doubtful = any(line.doubtful for line in lines)
    caption = (
        "Both axes are logarithmic; the lower left is best. Bars: intervals of the CPU time over the repeats. "
        "Pale staircase: the Pareto front, what no setting beats in both."
    )
    if doubtful:
        caption += f" Hollow: more than {WRONG_TEXT} of the {kind.things} missed or extra, so it counts nowhere."
    if any(found.error < found.reference_error for _, found in tradeoff.settings):
        caption += " Errors below what the reference was checked to are drawn there."
    return Figure(
        name,
        f"Error against run time: {scene}",
        f"Log-log plot of the {kind.typical} error of {kind.of} against CPU time. {sentences}",
        caption,
        lambda form, drawn: draw_panels([panel], form, drawn),
        tuple(Key(curve.label, curve.style) for curve in tradeoff.curves),
        file=f"accuracy/{name}.svg",
    )


def _line(curve: Curve, unit: Scale) -> Line:
    found = [setting for setting in curve.settings if setting.shown > 0]
    return Line(
        curve.label,
        curve.style,
        tuple(setting.cost.median / unit.factor for setting in found),
        tuple(setting.shown for setting in found),
        spans=tuple((setting.cost.low / unit.factor, setting.cost.high / unit.factor) for setting in found),
        doubtful=tuple(place for place, setting in enumerate(found) if not setting.sees_all_hits),
    )


def _in_words(curve: Curve) -> str:
    first, last = curve.settings[0], curve.settings[-1]
    ends = [
        f"{error_text(found.error, found.kind.unit)} in {quantity(found.cost.median, 's')}" for found in (first, last)
    ]
    return f"{curve.label}: an error of {' to '.join(dict.fromkeys(ends))}."


SOURCE = FigureSource(_figures)
