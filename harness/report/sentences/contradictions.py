"""What published rows say against one another, in sentences: computed from nothing but the rows themselves."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from harness.report.published import PublishedRow, Recovered, Repetition, recovered, repetitions
from harness.report.quantity import leaf_text, number


def contradictions(rows: Sequence[PublishedRow], elsewhere: Sequence[PublishedRow]) -> list[Markup]:
    """Bodies and frames that are not those printed, and rows that repeat others.

    Parameters
    ----------
    rows : of one experiment
    elsewhere : of the other experiments, which may be repeated
    """
    found = recovered(rows)
    return [*_bodies(found), *_frames(found), *(_repeats(entry) for entry in repetitions(rows, elsewhere))]


def _bodies(found: Sequence[Recovered]) -> list[Markup]:
    wrong = [entry for entry in found if not entry.bodies_agree]
    if not found:
        return []
    if not wrong:
        return [Markup("The number of bodies that the test counts imply is the one printed in every row.")]
    sentences = []
    whole = [entry for entry in wrong if entry.whole]
    broken = [entry for entry in wrong if not entry.whole]
    if whole:
        listed = Markup(", ").join(
            Markup("<strong>{}</strong> where {} is printed").format(number(round(entry.bodies)), number(entry.printed))
            for entry in whole
        )
        sentences.append(Markup("The test counts are those of another number of bodies: {}.").format(listed))
    if broken:
        listed = Markup(", ").join(
            Markup("<strong>{:.2f}</strong> where {} is printed").format(entry.bodies, number(entry.printed))
            for entry in broken
        )
        sentences.append(Markup("They fit no whole number of bodies at all: {}.").format(listed))
    return sentences


def _frames(found: Sequence[Recovered]) -> list[Markup]:
    wrong = [entry for entry in found if not entry.frames_agree and entry.frames_timed is not None]
    if not wrong:
        return []
    listed = Markup(", ").join(
        Markup("{} against {} ({})").format(
            number(round(entry.frames)), number(round(entry.frames_timed or 0)), entry.row.name
        )
        for entry in wrong
    )
    duration = next((leaf_text(entry.row.parameter("duration")) for entry in wrong), "")
    return [
        Markup("The frames that were tested are not those that the printed rate makes in {} s: {}.").format(
            duration, listed
        )
    ]


def _repeats(entry: Repetition) -> Markup:
    first, second = entry.first, entry.second
    if first.experiment == second.experiment:
        whose = Markup("Row <strong>{}</strong> repeats row <strong>{}</strong>").format(second.name, first.name)
    else:
        whose = Markup("Row <strong>{}</strong> repeats row <strong>{}</strong> of {}").format(
            first.name, second.name, second.experiment
        )
    text = whose + Markup(": the same {}").format(_listed(entry.same))
    if entry.differing:
        text += Markup("; only {} differ").format(
            _listed(
                [
                    f"{metric} ({number(first.numbers[metric])} and {number(second.numbers[metric])})"
                    for metric in entry.differing
                ]
            )
        )
    return text + Markup(".")


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
