"""The accuracy of an experiment's methods: the scenes on which they are compared, and what the page says of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from markupsafe import Markup

from harness.report.accuracy.decision import decision
from harness.report.accuracy.error_kind import GAPS, TIMES
from harness.report.accuracy.tables import every_setting, fastest, followed, orders
from harness.report.accuracy.texts import time_text
from harness.report.accuracy.tradeoffs import Tradeoff, tradeoffs
from harness.report.experiment import ExperimentPage
from harness.report.figure import Figure, figures_of
from harness.report.point import MeasuredPoint
from harness.report.quantity import number
from harness.report.table import Table

_MOST_SCENES = 6


@dataclass(frozen=True, eq=False)
class ExperimentAccuracy:
    """What the page of errors says of one experiment; `identity` is the id of its section there."""

    page: ExperimentPage
    identity: str
    tradeoffs: tuple[Tradeoff, ...]

    @cached_property
    def scenes(self) -> list[Tradeoff]:
        """Those on which methods are compared, one of them at several settings: the first few."""
        return [found for found in self.tradeoffs if found.is_curve and len(found.curves) > 1][:_MOST_SCENES]

    @cached_property
    def decisions(self) -> list[Markup]:
        """For each scene, what to use."""
        return [sentence for found in self.scenes if (sentence := decision(found)) is not None]

    @cached_property
    def figures(self) -> list[Figure]:
        """A work-precision diagram a scene, and whatever else there is to draw."""
        return [figure for figures in figures_of("accuracy", self).values() for figure in figures]

    @cached_property
    def tables(self) -> list[Table]:
        """Who is fastest at which error, orders of convergence, and every setting with its hits."""
        found = [fastest(tradeoff) for tradeoff in self.scenes]
        found += [table for table in (orders(self.tradeoffs),) if table is not None]
        for kind in (TIMES, GAPS):
            of_kind = [tradeoff for tradeoff in self.tradeoffs if tradeoff.kind is kind]
            found += [every_setting(of_kind)] if of_kind else []
        return [*found, *([followed(self.page.arrangement)] if self.free else [])]

    @property
    def free(self) -> bool:
        """Whether bodies answer hits, so that each method computes a motion of its own."""
        return any(point.summary("divergence_time") for point in self.page.arrangement.points)

    @cached_property
    def reference(self) -> Markup:
        """How far its reference is right, in sentences."""
        points, sentences = self.page.arrangement.points, []
        if (worst := _largest(points, "reference_error")) is not None:
            sentences.append(
                Markup(
                    "Of the reference's {} hits a sample was checked: its times are right to <strong>{}</strong>."
                ).format(number(_largest(points, "reference_hits")), time_text(worst))
            )
        if (bounds := _largest(points, "reference_gap_error")) is not None:
            pairs = number(_largest(points, "reference_pairs"))
            sentences.append(
                Markup(
                    "The gaps of {} near pairs were bounded from both sides, by points and by planes, to "
                    "<strong>{} m</strong>."
                ).format(pairs, number(bounds))
            )
        if (agrees := _largest(points, "reference_divergence_time")) is not None:
            sentences.append(
                Markup(
                    "Computed again in another unit of length, and so rounded otherwise, the reference shares its hits "
                )
                + Markup("for <strong>{}</strong>").format(time_text(agrees))
            )
            apart = _largest(points, "reference_position_error")
            sentences[-1] += (
                Markup(", and its places to {} m.").format(number(apart)) if apart is not None else Markup(".")
            )
        return Markup(" ").join(sentences)


def accuracy_of(pages: Sequence[ExperimentPage]) -> list[ExperimentAccuracy]:
    """The experiments that measure errors against a reference, those with something to draw first."""
    found: list[ExperimentAccuracy] = []
    for page in pages:
        accuracy = ExperimentAccuracy(page, f"scene{len(found)}", tuple(tradeoffs(page.record, page.arrangement)))
        if accuracy.tradeoffs or accuracy.free:
            found.append(accuracy)
    return sorted(found, key=lambda accuracy: not accuracy.scenes)


def _largest(points: Sequence[MeasuredPoint], metric: str) -> float | None:
    return max((value for point in points if math.isfinite(value := point.median(metric))), default=None)
