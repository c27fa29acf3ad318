"""Error against run time: what each method costs at each setting of its knob, how far it is right, and who leads.

A *curve* is a method at all settings of its knob: the time step or, of one that computes events, the tolerance. A
*scene* is all that is not the method's. Errors below the checked error of the reference mean no more than that.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.measure.resolution import Distinction, Resolution
from harness.measure.statistics import Exponent, Summary, fit_exponent
from harness.report.accuracy.error_kind import ErrorKind, error_kind
from harness.report.methods import method_label
from harness.report.point import MeasuredPoint
from harness.report.ranking import tell_apart, times_worse
from harness.report.series import Arrangement
from harness.report.styles import styles_of
from harness.report.words import leaf_label
from harness.store.records import ExperimentRecord
from harness.vocabulary import KNOBS, METHOD_LEAVES, MethodName

COST = "run_seconds"
# Of the reference's hits, how many a method may miss, and how many more it may report, to count as right.
MOST_WRONG = 0.01
FEWEST_SETTINGS = 3
# What follows from the mesh and the box: it tells no scenes apart that these do not.
_FOLLOWS = ("faces", "hull_vertices", "packing", "box_side")


@dataclass(frozen=True, eq=False)
class Setting:
    """A method at one setting of its knob; its error is of a kind."""

    point: MeasuredPoint
    knob: float
    cost: Summary
    error: float
    reference_error: float
    kind: ErrorKind

    @property
    def wrong(self) -> float:
        """The larger of the shares of what it missed and of what it invented; 0 where they are not matched."""
        names = (self.kind.missed, self.kind.extra)
        return max((share for name in names if (share := self.point.median(name)) > 0), default=0)

    @property
    def sees_all_hits(self) -> bool:
        """Whether it sees the hits that there are, all but a few, so that its error is one of all of them."""
        return self.wrong <= MOST_WRONG

    @property
    def shown(self) -> float:
        """Its error, or the reference's where that is larger: no smaller error means anything."""
        return max(self.error, self.reference_error)

    def reaches(self, target: float) -> bool:
        """Whether it counts as right to within the target."""
        return self.sees_all_hits and self.error <= target


@dataclass(frozen=True, eq=False)
class Curve:
    """A method with its settings, the cheapest first; `label` sets it apart from the others of its scene."""

    method: MethodName
    label: str
    style: int
    settings: tuple[Setting, ...]

    @property
    def knob(self) -> str:
        """The leaf that is set; "" where there is none, because the method is exact."""
        return self.method.knob

    def cheapest(self, target: float) -> Setting | None:
        """Its cheapest setting that reaches an error."""
        return next((found for found in self.settings if found.reaches(target)), None)

    @property
    def order(self) -> Exponent | None:
        """The power of the time step with which the error falls; None of methods without one."""
        if self.method.knob != "dt":
            return None
        fit = fit_exponent({found.knob: [found.error] for found in self.settings if found.sees_all_hits})
        return fit if fit.n >= 2 else None


@dataclass(frozen=True, eq=False)
class Costed:
    """A method at its cheapest setting that reaches an error.

    Parameters
    ----------
    ratio : how many times it costs what the cheapest method costs; None of that itself, and where nothing can be paired
    distinction : whether that ratio is told from 1
    """

    curve: Curve
    setting: Setting
    ratio: Summary | None
    distinction: Distinction

    @property
    def tied(self) -> bool:
        """Whether it is the cheapest, or cannot be told apart from it."""
        return self.distinction != "apart"


@dataclass(frozen=True, eq=False)
class Tradeoff:
    """All methods on one scene of one experiment; `place` sets the scene apart from the others of the experiment."""

    record: ExperimentRecord
    place: str
    curves: tuple[Curve, ...]
    resolution: Resolution

    @property
    def kind(self) -> ErrorKind:
        """What errors are here, of all methods alike."""
        return self.curves[0].settings[0].kind

    @property
    def settings(self) -> list[tuple[Curve, Setting]]:
        """Every method at every setting."""
        return [(curve, found) for curve in self.curves for found in curve.settings]

    @property
    def is_curve(self) -> bool:
        """Whether there is something to draw: a method at several settings."""
        return any(len(curve.settings) >= FEWEST_SETTINGS for curve in self.curves)

    @property
    def front(self) -> list[Setting]:
        """The settings that no other beats in both cost and error, the cheapest first: the Pareto front."""
        best, found = math.inf, []
        for candidate in sorted(
            (s for _, s in self.settings if s.sees_all_hits), key=lambda s: (s.cost.median, s.shown)
        ):
            if candidate.shown < best:
                best = candidate.shown
                found.append(candidate)
        return found

    def ranked(self, target: float) -> list[tuple[Curve, Setting]]:
        """The methods that reach an error, each at its cheapest setting, the cheapest method first."""
        found = [(curve, cheapest) for curve in self.curves if (cheapest := curve.cheapest(target)) is not None]
        found.sort(key=lambda entry: entry[-1].cost.median)
        return found

    def ratios(self, target: float) -> list[Costed]:
        """The same, each with how many times it costs what the first costs."""
        ranked = self.ranked(target)
        if not ranked:
            return []
        (_, cheapest), *_ = ranked
        best = cheapest.point
        return [
            Costed(
                curve, found, times_worse(found.point, best, COST), tell_apart(found.point, best, COST, self.resolution)
            )
            if place
            else Costed(curve, found, None, "same")
            for place, (curve, found) in enumerate(ranked)
        ]

    @property
    def decided(self) -> float | None:
        """The error at which to say what to use: the preferred one, else the smallest that anything reaches."""
        reached, preferred = [target for target in self.kind.targets if self.ranked(target)], self.kind.preferred
        return preferred if preferred in reached else min(reached, default=None)


def tradeoffs(record: ExperimentRecord, arrangement: Arrangement) -> list[Tradeoff]:
    """The trade-offs of an experiment that declares a reference, one a scene; none of any other."""
    if not (record.specification.get("measure") or {}).get("reference"):
        return []
    scenes: dict[str, list[MeasuredPoint]] = {}
    for point in arrangement.points:
        scenes.setdefault(_key(point, lambda leaf: leaf not in METHOD_LEAVES and leaf not in _FOLLOWS), []).append(
            point
        )
    leaves = _differing([points[0] for points in scenes.values()], lambda leaf: leaf not in METHOD_LEAVES)
    found = []
    for points in scenes.values():
        curves = _curves(points)
        if curves:
            place = ", ".join(leaf_label(leaf, points[0].parameters.get(leaf)) for leaf in leaves)
            found.append(Tradeoff(record, place, curves, arrangement.resolution(COST)))
    return found


def _curves(points: Sequence[MeasuredPoint]) -> tuple[Curve, ...]:
    grouped: dict[str, list[MeasuredPoint]] = {}
    for point in points:
        grouped.setdefault(_key(point, _is_of_curve), []).append(point)
    leaves = _differing([members[0] for members in grouped.values()], _is_of_curve)
    made: list[tuple[MethodName, str, tuple[Setting, ...]]] = []
    for members in grouped.values():
        first = members[0].parameters
        method = MethodName.of(first)
        settings = [found for point in members if (found := _setting(point, method.knob or "tolerance")) is not None]
        label = method_label(first, leaves) or method.label
        if settings:
            ordered = tuple(sorted(settings, key=lambda found: found.cost.median))
            made.append((method, label, ordered))
    styles = styles_of({label: method for method, label, _ in made})
    return tuple(Curve(method, label, styles[label], ordered) for method, label, ordered in made)


def _is_of_curve(leaf: str) -> bool:
    """Whether a leaf tells one curve from another: it says which method, and does not set its knob."""
    return leaf in METHOD_LEAVES and leaf not in KNOBS


def _setting(point: MeasuredPoint, knob: str) -> Setting | None:
    kind = error_kind(point.parameters)
    cost, error = point.summary(COST), point.median(kind.metric)
    if cost is None or not math.isfinite(error) or not cost.median > 0:
        return None
    checked = point.median(kind.reference)
    known = checked if math.isfinite(checked) else 0.0
    return Setting(point, float(point.parameters[knob]), cost, error, known, kind)


def _differing(points: Sequence[MeasuredPoint], wanted: Callable[[str], bool]) -> list[str]:
    leaves = [leaf for leaf in points[0].parameters if wanted(leaf) and leaf not in _FOLLOWS] if points else []
    return [leaf for leaf in leaves if len({_text(point, leaf) for point in points}) > 1]


def _key(point: MeasuredPoint, wanted: Callable[[str], bool]) -> str:
    return json.dumps({leaf: value for leaf, value in point.parameters.items() if wanted(leaf)}, sort_keys=True)


def _text(point: MeasuredPoint, leaf: str) -> str:
    return json.dumps(point.parameters.get(leaf), sort_keys=True)
