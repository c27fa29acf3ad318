"""The page of errors against run time: work-precision figures, who is fastest at which error, orders, missed hits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from markupsafe import Markup

from harness.measure.statistics import CONFIDENCE, Summary
from harness.report.drawing import Line, Panel, draw_panels
from harness.report.figures import Figure, Key
from harness.report.pages import ExperimentPage
from harness.report.quantity import Scale, exponent_text, leaf_text, number, power_of_ten, quantity, scale
from harness.report.series import Arrangement, MeasuredPoint
from harness.report.table import Column, Entry, Table, counted, measured, plain, words
from harness.report.tables import place_of
from harness.report.tradeoffs import MOST_WRONG, TARGETS, Curve, Setting, Tradeoff, tradeoffs
from harness.report.words import metric_title, metric_unit, scene_text

_MOST_SCENES = 6
_WRONG = f"{100 * MOST_WRONG:g} %"


@dataclass(frozen=True, eq=False)
class AccuracySection:
    """What the page says of one experiment."""

    page: ExperimentPage
    identity: str
    tradeoffs: tuple[Tradeoff, ...]

    @property
    def href(self) -> str:
        """The experiment's own page, seen from this one."""
        return f"{self.page.folder}/index.html"

    @cached_property
    def curves(self) -> list[Tradeoff]:
        """The scenes on which methods are compared, one of them at several settings."""
        return [found for found in self.tradeoffs if found.is_curve and len(found.curves) > 1]

    @cached_property
    def decisions(self) -> list[Markup]:
        """For each scene, what to use."""
        return [sentence for found in self.curves[:_MOST_SCENES] if (sentence := decision(found)) is not None]

    @cached_property
    def figures(self) -> list[Figure]:
        """A work-precision diagram a scene."""
        return [
            replace(figure, file=f"accuracy/{figure.name}.svg")
            for place, found in enumerate(self.curves[:_MOST_SCENES])
            for figure in [work_precision(found, f"{self.identity}-{place}")]
        ]

    @cached_property
    def tables(self) -> list[Table]:
        """Who is fastest at which error, orders of convergence, and every setting with its hits."""
        found = [fastest(tradeoff) for tradeoff in self.curves[:_MOST_SCENES]]
        found += [table for table in (orders(self.tradeoffs),) if table is not None]
        found += [hits(self.tradeoffs)] if self.tradeoffs else []
        return [*found, *([followed(self.page.arrangement)] if self.free else [])]

    @property
    def free(self) -> bool:
        """Whether bodies answer hits, so that each method flies its own motion."""
        return any(point.summary("divergence_time") for point in self.page.arrangement.points)

    @cached_property
    def trust(self) -> Markup:
        """How far its reference is right."""
        points, said = self.page.arrangement.points, []
        if (worst := _largest(points, "reference_error")) is not None:
            said.append(
                Markup(
                    "Of the reference's {} hits a sample was checked: its times are right to <strong>{}</strong>."
                ).format(number(_largest(points, "reference_hits")), _time(worst))
            )
        if (agrees := _largest(points, "reference_divergence_time")) is not None:
            said.append(
                Markup(
                    "Flown again in another unit of length, and so rounded otherwise, the reference shares its hits "
                )
                + Markup("for <strong>{}</strong>").format(_time(agrees))
            )
            apart = _largest(points, "reference_position_error")
            said[-1] += Markup(", and its places to {} m.").format(number(apart)) if apart is not None else Markup(".")
        return Markup(" ").join(said)


def sections(pages: Sequence[ExperimentPage]) -> list[AccuracySection]:
    """The experiments that measure errors against a reference."""
    found: list[AccuracySection] = []
    for page in pages:
        section = AccuracySection(page, f"scene{len(found)}", tuple(tradeoffs(page.record, page.arrangement)))
        if section.tradeoffs or section.free:
            found.append(section)
    return sorted(found, key=lambda section: not section.curves)


def decision(tradeoff: Tradeoff) -> Markup | None:
    """What to use for this scene: the cheapest method at an error, and how far the next is behind."""
    target = tradeoff.decided
    if target is None:
        return None
    (curve, setting, _), *others = tradeoff.lead(target)
    text = Markup("For {} at an error of {}, use <strong>{}</strong>{}, {} of CPU time").format(
        scene_of(tradeoff),
        _target(target),
        curve.label,
        _knob_text(curve, setting),
        quantity(setting.cost.median, "s"),
    )
    level = [other.label for other, _, behind in others if tradeoff.level(behind)]
    behind = [(other, found, ratio) for other, found, ratio in others if not tradeoff.level(ratio)]
    if level:
        text += Markup(", not to be told from {}").format(" and ".join(level))
    if behind:
        other, found, ratio = behind[0]
        text += Markup(": <strong>{}×</strong>{} cheaper than {}{}").format(
            number(ratio.median if ratio else math.nan), _interval(ratio), other.label, _knob_text(other, found)
        )
    lost = [curve.label for curve in tradeoff.curves if curve.cheapest(target) is None]
    if lost:
        text += Markup("; {} {} not reach it").format(", ".join(lost), "does" if len(lost) == 1 else "do")
    return text + Markup(".")


def scene_of(tradeoff: Tradeoff) -> str:
    """The scene in a phrase."""
    first = dict(tradeoff.curves[0].settings[0].point.parameters)
    shapes = {s.point.parameters.get("shape") for _, s in tradeoff.settings}
    first["shape"] = next((shape for shape in ("mesh", "hull", "sphere") if shape in shapes), None)
    if first.get("count") is None and isinstance(first.get("bodies"), list):
        first["count"] = len(first["bodies"])
    return ", ".join(part for part in (scene_text(first), tradeoff.place) if part)


def work_precision(tradeoff: Tradeoff, name: str) -> Figure:
    """Error against CPU time, a curve a method, with the front that nothing beats."""
    unit = scale([found.cost.median for _, found in tradeoff.settings], "s")
    lines = tuple(_line(curve, unit) for curve in tradeoff.curves)
    # an error of exactly 0, where nothing is known of the reference, has no place on a logarithmic axis
    front = tuple((found.cost.median / unit.factor, found.shown) for found in tradeoff.front if found.shown > 0)
    panel = Panel(
        "", f"CPU time, {unit.symbol}", "median error of the times of hits, s", lines, logarithmic=True, front=front,
        rounded=True,
    )  # fmt: skip
    scene = scene_of(tradeoff)
    said = " ".join(_spoken(curve) for curve in tradeoff.curves)
    doubtful = any(line.doubtful for line in lines)
    caption = (
        "Both axes are logarithmic; the lower left is best. Bars: intervals of the CPU time over the repeats. "
        "Pale staircase: the Pareto front, what no setting beats in both."
    )
    if doubtful:
        caption += f" Hollow: more than {_WRONG} of the hits missed or extra, so it counts nowhere."
    if any(found.error < found.trust for _, found in tradeoff.settings):
        caption += " Errors below what the reference was checked to are drawn there."
    return Figure(
        name,
        f"Error against run time: {scene}",
        f"Log-log plot of the median time error of hits against CPU time. {said}",
        caption,
        lambda form, drawn: draw_panels([panel], form, drawn),
        tuple(Key(curve.label, curve.style) for curve in tradeoff.curves),
    )


def fastest(tradeoff: Tradeoff) -> Table:
    """The CPU time of every method at every error, at its cheapest setting that reaches it."""
    unit = scale([found.cost.median for _, found in tradeoff.settings], "s")
    rows = []
    for target in TARGETS:
        lead = {curve.label: (found, behind) for curve, found, behind in tradeoff.lead(target)}
        row = [Entry(_target(target), numeric=False, sort=target)]
        for curve in tradeoff.curves:
            if curve.label not in lead:
                row.append(Entry("", flag=_why_not(curve), sort=math.inf))
                continue
            found, behind = lead[curve.label]
            half = (found.cost.high - found.cost.low) / 2
            margin = f"±{unit.margin(found.cost.median, half)}" if half > 0 else ""
            small = ", ".join(part for part in (margin, _knob_text(curve, found).strip(" ()")) if part)
            mark = "best" if tradeoff.level(behind) else ""
            row.append(Entry(unit.text(found.cost.median), small, mark=mark, sort=plain(found.cost.median)))
        rows.append(tuple(row))
    columns = (Column("Error", numeric=False), *(Column(curve.label, unit.symbol) for curve in tradeoff.curves))
    note = (
        f"CPU time of the cheapest setting that was measured to have no larger a median error, in {unit.symbol}, with "
        "half its interval and its setting. Bold: cheapest, or not to be told from it. A method that misses more than "
        f"{_WRONG} of the hits, or reports as many that are none, does not reach any error."
    )
    return Table(f"Fastest at an error: {scene_of(tradeoff)}", note, columns, tuple(rows))


def orders(found: Sequence[Tradeoff]) -> Table | None:
    """The observed order of convergence of every stepped method."""
    rows = []
    for tradeoff in found:
        for curve in tradeoff.curves:
            fit = curve.order
            if fit is None or not fit.enough:
                continue
            interval = f"{exponent_text(fit.low)} to {exponent_text(fit.high)}"
            name = ", ".join(part for part in (curve.label, tradeoff.place) if part)
            rows.append(
                (
                    words(name, curve.style),
                    Entry(exponent_text(fit.value), sort=plain(fit.value)),
                    Entry(interval, sort=plain(fit.low)),
                    counted(fit.n),
                    Entry(f"{number(fit.range_factor)}×", sort=plain(fit.range_factor)),
                )
            )
    if not rows:
        return None
    columns = (
        Column("Method", numeric=False), Column("order"), Column(f"{CONFIDENCE * 100:.0f} % interval"),
        Column("time steps"), Column("range of them"),
    )  # fmt: skip
    note = (
        "The power of the time step with which the median error falls. A frame shows a hit late by half its length in "
        "the middle, so the order to be expected is 1."
    )
    return Table("Observed order of convergence", note, columns, tuple(rows))


def hits(found: Sequence[Tradeoff]) -> Table:
    """Every method at every setting: its cost, its errors, and the hits that it missed or invented."""
    settings = [(tradeoff, curve, entry) for tradeoff in found for curve, entry in tradeoff.settings]
    unit = scale([entry.cost.median for _, _, entry in settings], "s")
    places = any(tradeoff.place for tradeoff in found)
    expected = any(entry.point.summary("missed_hits_expected") for _, _, entry in settings)
    rows = []
    for tradeoff, curve, entry in settings:
        row = [words(curve.label, curve.style)]
        row += [words(tradeoff.place)] if places else []
        knob = f"{curve.knob} {leaf_text(entry.knob)}" if curve.knob else "exact"
        row += [Entry(knob, numeric=False, mark="keep", sort=entry.knob)]
        row += [Entry(unit.text(entry.cost.median), sort=plain(entry.cost.median))]
        row += [_seconds(entry.point.median(name)) for name in ("time_error", "time_error_95")]
        row += [_share(entry.point.median(name)) for name in ("missed_hits", "extra_hits")]
        row += [_share(entry.point.median("missed_hits_expected"), flagged=False)] if expected else []
        row += [counted(entry.point.median("reference_hits"))]
        rows.append(tuple(row))
    columns = [Column("Method", numeric=False)]
    columns += [Column("Scene", numeric=False)] if places else []
    columns += [Column("Setting", numeric=False), Column("CPU time", unit.symbol), Column("Median error", "s")]
    columns += [Column("95th percentile", "s"), Column("Missed"), Column("Extra")]
    columns += [Column("Missed by the formula")] if expected else []
    columns += [Column("Hits of the reference")]
    note = f"Missed and extra hits are shares of the reference's hits; above {_WRONG} they are flagged."
    if expected:
        note += " By the tunnelling formula, a contact of length τ is missed with the probability max(0, 1 − τ/dt)."
    return Table("Every setting, and the hits it saw", note, tuple(columns), tuple(rows))


def followed(arrangement: Arrangement) -> Table:
    """In free flight: until when every method shares the reference's hits, how far it is off, and what it conserves."""
    shown = [name for name in _FREE if any(point.summary(name) for point in arrangement.points)]
    units = {name: scale([point.median(name) for point in arrangement.points], metric_unit(name)) for name in shown}
    rows = []
    for series in arrangement.series:
        for point, x in zip(series.points, series.x, strict=True):
            row = [words(place_of(arrangement, series, x), series.style)]
            rows.append(tuple(row + [measured(point, name, units[name]) for name in shown]))
    titles = [metric_title(name) for name in shown]
    columns = [
        Column(f"{title[:1].upper()}{title[1:]}", units[name].symbol)
        for name, title in zip(shown, titles, strict=True)
    ]  # fmt: skip
    note = (
        "Bodies answer their hits, so each method flies its own motion. It is compared with the reference up to the "
        "first hit of any body that differs; places at up to 256 times until then. After that chaos leaves only what "
        "is conserved, and how often bodies hit."
    )
    return Table(
        "How long the exact motion is followed", note, (Column("Method", numeric=False), *columns), tuple(rows)
    )


_FREE = (
    "run_seconds", "divergence_time", "position_error", "energy_drift", "momentum_drift", "max_penetration",
    "collision_rate",
)  # fmt: skip


def _largest(points: Sequence[MeasuredPoint], metric: str) -> float | None:
    return max((value for point in points if math.isfinite(value := point.median(metric))), default=None)


def _line(curve: Curve, unit: Scale) -> Line:
    found = [setting for setting in curve.settings if setting.shown > 0]
    return Line(
        curve.label,
        curve.style,
        tuple(setting.cost.median / unit.factor for setting in found),
        tuple(setting.shown for setting in found),
        spans=tuple((setting.cost.low / unit.factor, setting.cost.high / unit.factor) for setting in found),
        doubtful=tuple(place for place, setting in enumerate(found) if not setting.sound),
    )


def _spoken(curve: Curve) -> str:
    first, last = curve.settings[0], curve.settings[-1]
    ends = [f"{_time(found.error)} in {quantity(found.cost.median, 's')}" for found in (first, last)]
    return f"{curve.label}: an error of {' to '.join(dict.fromkeys(ends))}."


def _why_not(curve: Curve) -> str:
    """Why a method does not reach an error."""
    sound = [found.error for found in curve.settings if found.sound]
    if sound:
        return f"{_time(min(sound))} at best"
    return f"{number(100 * min(found.wrong for found in curve.settings))} % of hits wrong"


def _knob_text(curve: Curve, setting: Setting) -> str:
    """The setting in brackets, where the method has several."""
    several = curve.knob and len({found.knob for found in curve.settings}) > 1
    return f" ({curve.knob} {leaf_text(setting.knob)})" if several else ""


def _target(target: float) -> str:
    return f"{power_of_ten(round(math.log10(target)))}\u00a0s"


def _time(value: float) -> str:
    """A time; what no clock has ever told apart stays in seconds."""
    return quantity(value, "s") if value >= 1e-9 or value == 0.0 else f"{number(value)}\u00a0s"


def _seconds(value: float) -> Entry:
    return Entry(number(value), sort=plain(value))


def _share(value: float, flagged: bool = True) -> Entry:
    if not math.isfinite(value):
        return Entry("–")
    text = f"{number(100 * value)} %"
    over = flagged and value > MOST_WRONG
    return Entry("" if over else text, flag=text if over else "", sort=plain(value))


def _interval(ratio: Summary | None) -> str:
    if ratio is None or ratio.n < 2:
        return ""
    text = f" [{number(ratio.low)}, {number(ratio.high)}]"
    return text if ratio.coverage is not None else f"{text} (range)"
