"""What to use for a scene, in a sentence."""

from __future__ import annotations

import math

from markupsafe import Markup

from harness.report.accuracy.texts import interval_text, knob_text, scene_of, target_text
from harness.report.accuracy.tradeoffs import Tradeoff
from harness.report.quantity import number, quantity


def decision(tradeoff: Tradeoff) -> Markup | None:
    """What to use for this scene: the cheapest method at an error, and how far the next is behind."""
    target = tradeoff.decided
    if target is None:
        return None
    (curve, setting, _), *others = tradeoff.lead(target)
    text = Markup("For {} at an error of {}, use <strong>{}</strong>{}, {} of CPU time").format(
        scene_of(tradeoff),
        target_text(target),
        curve.label,
        knob_text(curve, setting),
        quantity(setting.cost.median, "s"),
    )
    level = [other.label for other, _, behind in others if tradeoff.level(behind)]
    behind = [(other, found, ratio) for other, found, ratio in others if not tradeoff.level(ratio)]
    if level:
        text += Markup(", not to be told from {}").format(" and ".join(level))
    if behind:
        other, found, ratio = behind[0]
        text += Markup(": <strong>{}×</strong>{} cheaper than {}{}").format(
            number(ratio.median if ratio else math.nan), interval_text(ratio), other.label, knob_text(other, found)
        )
    lost = [curve.label for curve in tradeoff.curves if curve.cheapest(target) is None]
    if lost:
        text += Markup("; {} {} not reach it").format(", ".join(lost), "does" if len(lost) == 1 else "do")
    return text + Markup(".")
