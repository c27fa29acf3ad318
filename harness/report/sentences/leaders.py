"""Who is ahead, and by how much, or why that cannot be said: at either end of x, in every panel."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from harness.report.quantity import quantity
from harness.report.ranking import Ranked, rank, unranked
from harness.report.sentences.ratio import ratio_text
from harness.report.series import Arrangement
from harness.report.words import (
    SCENE_LEAVES,
    is_noisy,
    leaf_label,
    metric_title,
    metric_unit,
    more_is_better,
    scene_text,
)

# Up to this ratio, medians are about the same.
_ALIKE = 1.1


def leader_sentences(arrangement: Arrangement) -> list[Markup]:
    """A sentence for each scene on which methods can be ranked."""
    found = []
    methods = arrangement.methods
    xs = arrangement.x_values or (None,)
    many = len(arrangement.panels) > 2
    # the far end first: that is where methods part
    ends = xs[:4] if not arrangement.numeric else (xs[-1:] if many or len(xs) == 1 else (xs[-1], xs[0]))
    metrics = [metric for metric in arrangement.metrics if is_noisy(metric)][: 1 if many else 2]
    for metric in metrics:
        for panel in arrangement.panels:
            lines = [series for series in methods if series.panel == panel]
            for x in ends if methods is arrangement.series else (None,):
                ranked = rank(lines, x, metric, arrangement.resolution(metric))
                # what is 0 for the best was not done at all, as where no wall is tested
                if len(ranked) > 1 and all(entry.median != 0.0 for entry in ranked):
                    found.append(_lead(arrangement, ranked, panel, x, metric))
    return found


def _lead(arrangement: Arrangement, ranked: Sequence[Ranked], panel: str, x: object, metric: str) -> Markup:
    best, tied = ranked[0], [entry for entry in ranked if entry.tied]
    where = Markup("For {}: ").format(_scene(arrangement, ranked, panel, x))
    why_not = unranked(entry.distinction for entry in ranked)
    if why_not:
        return where + _medians(ranked, metric) + Markup(": {}.").format(why_not)
    most = "highest" if more_is_better(metric) else "lowest"
    value = quantity(best.median, metric_unit(metric))
    ahead = Markup("that is ")
    if len(tied) > 1:
        names = " and ".join(entry.series.label for entry in tied)
        rank_text = "" if len(tied) == len(ranked) else f"the {most}, "
        text = Markup("{}{} cannot be told apart in {}, {}{}").format(
            where, names, metric_title(metric), rank_text, _about([entry.median for entry in tied], metric)
        )
        ahead = Markup("{} is ").format(best.series.label)
    else:
        text = Markup("{}<strong>{}</strong> has the {} {}, <strong>{}</strong>").format(
            where, best.series.label, most, metric_title(metric), value
        )
    behind = [entry for entry in ranked if not entry.tied]
    if behind:
        chosen = dict.fromkeys((behind[0].series.label, behind[-1].series.label))
        named = [entry for entry in behind if entry.series.label in chosen]
        parts = [
            Markup("{} ahead of {}").format(ratio_text(entry.ratio), entry.series.label)
            for entry in named
            if entry.ratio is not None
        ]
        text += Markup("; ") + ahead + Markup(", ").join(parts)
    return text + Markup(".")


def _about(medians: Sequence[float], metric: str) -> Markup:
    """What several medians that cannot be told apart are: about the best of them, or from the least to the largest."""
    least, largest = (quantity(end, metric_unit(metric)) for end in (min(medians), max(medians)))
    if max(medians) <= _ALIKE * min(medians):
        return Markup("about <strong>{}</strong>").format(quantity(medians[0], metric_unit(metric)))
    return Markup("with medians from <strong>{}</strong> to <strong>{}</strong>").format(least, largest)


def _medians(ranked: Sequence[Ranked], metric: str) -> Markup:
    """The medians with their ranges, in the order of the series and not of a rank."""
    parts = []
    for entry in sorted(ranked, key=lambda entry: entry.series.style):
        found = entry.point.summary(metric)
        text = Markup("{} <strong>{}</strong>").format(entry.series.label, quantity(entry.median, metric_unit(metric)))
        if found is not None and found.n > 1:
            ends = (quantity(end, metric_unit(metric)) for end in (found.low, found.high))
            text += Markup(" ({} to {})").format(*ends)
        parts.append(text)
    listed = Markup(", ").join(parts)
    return Markup("{} is {}").format(metric_title(metric), listed)


def _scene(arrangement: Arrangement, ranked: Sequence[Ranked], panel: str, x: object) -> str:
    """The scene of methods that are ranked, what they are asked if that is one thing, and what else of it is swept."""
    parameters = dict(ranked[0].point.parameters)
    several = len({entry.point.parameters.get("query") for entry in ranked}) > 1
    if several or "query" in (arrangement.x, arrangement.panel_leaf):
        parameters["query"] = None
    parts = [scene_text(parameters)]
    if arrangement.x and x is not None and arrangement.x not in SCENE_LEAVES:
        parts.append(leaf_label(arrangement.x, x))
    if panel and arrangement.panel_leaf not in SCENE_LEAVES:
        parts.append(panel)
    return ", ".join(parts)
