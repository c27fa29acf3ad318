"""What to use for a scene, in a sentence."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.accuracy.texts import knob_text, scene_of, target_text
from harness.report.accuracy.tradeoffs import Costed, Tradeoff
from harness.report.quantity import quantity
from harness.report.ranking import unranked
from harness.report.sentences.ratio import ratio_text


def decision(tradeoff: Tradeoff) -> Markup | None:
    """What to use for this scene: the cheapest method at an error, and how much more the next costs."""
    target = tradeoff.decided
    if target is None:
        return None
    found = tradeoff.ratios(target)
    best, *others = found
    what = Markup("For {} at an error of {}, ").format(scene_of(tradeoff), target_text(target, tradeoff.kind.unit))
    why_not = unranked(entry.distinction for entry in found)
    if why_not:
        costs = Markup(", ").join(_cost(entry) for entry in sorted(found, key=lambda entry: entry.curve.style))
        return what + Markup("the CPU time is {}: {}.").format(costs, why_not)
    text = what + Markup("use <strong>{}</strong>{}, {} of CPU time").format(
        best.curve.label, knob_text(best.curve, best.setting), quantity(best.setting.cost.median, "s")
    )
    tied = [entry.curve.label for entry in others if entry.tied]
    dearer = [(entry, entry.ratio) for entry in others if not entry.tied and entry.ratio is not None]
    if tied:
        text += Markup(", not to be told from {}").format(" and ".join(tied))
    if dearer:
        next_one, ratio = dearer[0]
        text += Markup(": {} cheaper than {}{}").format(
            ratio_text(ratio), next_one.curve.label, knob_text(next_one.curve, next_one.setting)
        )
    short = [curve.label for curve in tradeoff.curves if curve.cheapest(target) is None]
    if short:
        text += Markup("; {} {} not reach it").format(", ".join(short), "does" if len(short) == 1 else "do")
    return text + Markup(".")


def _cost(entry: Costed) -> Markup:
    """What a method costs, with the range of its repeats."""
    cost = entry.setting.cost
    text = Markup("{}{} <strong>{}</strong>").format(
        entry.curve.label, knob_text(entry.curve, entry.setting), quantity(cost.median, "s")
    )
    if cost.n > 1:
        text += Markup(" ({} to {})").format(quantity(cost.low, "s"), quantity(cost.high, "s"))
    return text
