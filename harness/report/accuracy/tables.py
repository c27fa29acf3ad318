"""The tables of errors against run time: who is fastest at which error, orders of convergence, every setting."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.measure.statistics import CONFIDENCE
from harness.report.accuracy.texts import WRONG_TEXT, error_text, knob_text, scene_of, target_text
from harness.report.accuracy.tradeoffs import MOST_WRONG, Curve, Tradeoff
from harness.report.quantity import exponent_text, leaf_text, number, scale
from harness.report.ranking import unranked
from harness.report.series import Arrangement
from harness.report.table import Column, Entry, Table, counted, measured, plain, words
from harness.report.tables.naming import heading, place_of
from harness.report.words import metric_unit

# Of motions in which each method answers its own hits.
_FREE = (
    "run_seconds", "divergence_time", "position_error", "energy_drift", "momentum_drift", "max_penetration",
    "collision_rate",
)  # fmt: skip


def fastest(tradeoff: Tradeoff) -> Table:
    """The CPU time of every method at every error, at its cheapest setting that reaches it."""
    unit = scale([found.cost.median for _, found in tradeoff.settings], "s")
    rows = []
    reasons: dict[str, None] = {}  # why errors have no cheapest method
    kind = tradeoff.kind
    for target in kind.targets:
        reached = {entry.curve.label: entry for entry in tradeoff.ratios(target)}
        why_not = unranked(entry.distinction for entry in reached.values())
        reasons |= {why_not: None} if why_not else {}
        row = [Entry(target_text(target, kind.unit), numeric=False, sort=target)]
        for curve in tradeoff.curves:
            if curve.label not in reached:
                row.append(Entry("", flag=_why_not(curve), sort=math.inf))
                continue
            found = reached[curve.label].setting
            half = (found.cost.high - found.cost.low) / 2
            margin = f"±{unit.margin(found.cost.median, half)}" if half > 0 else ""
            small = ", ".join(part for part in (margin, knob_text(curve, found).strip(" ()")) if part)
            mark = "best" if reached[curve.label].tied and not why_not else ""
            row.append(Entry(unit.text(found.cost.median), small, mark=mark, sort=plain(found.cost.median)))
        rows.append(tuple(row))
    columns = (Column("Error", numeric=False), *(Column(curve.label, unit.symbol) for curve in tradeoff.curves))
    note = (
        f"CPU time of the cheapest setting whose {kind.typical} error of {kind.of} was measured to be no larger, in "
        f"{unit.symbol}, with half its interval and its setting. Bold: cheapest, or not to be told from it. A method "
        f"that misses more than {WRONG_TEXT} of the {kind.things}, or reports as many that are none, reaches no "
        "error."
    )
    if reasons:
        note += f" Nothing is bold for {', or '.join(reasons)}."
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


def every_setting(found: Sequence[Tradeoff]) -> Table:
    """Every method at every setting: its cost, its errors, and what it missed or invented; of one kind of error."""
    kind = found[0].kind
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
        row += [_error(entry.point.median(name)) for name in (kind.metric, kind.tail)]
        row += [_share(entry.point.median(name)) for name in (kind.missed, kind.extra)]
        row += [_share(entry.point.median("missed_hits_expected"), flagged=False)] if expected else []
        row += [counted(entry.point.median(kind.known))]
        rows.append(tuple(row))
    columns = [Column("Method", numeric=False)]
    columns += [Column("Scene", numeric=False)] if places else []
    columns += [
        Column("Setting", numeric=False),
        Column("CPU time", unit.symbol),
        Column(f"{kind.typical.capitalize()} error", kind.unit),
    ]
    columns += [Column(kind.tail_title, kind.unit), Column("Missed"), Column("Extra")]
    columns += [Column("Missed by the formula")] if expected else []
    columns += [Column(f"{kind.things.capitalize()} of the reference")]
    things = kind.things
    note = f"Missed and extra {things} are shares of the reference's {things}; above {WRONG_TEXT} they are flagged."
    if expected:
        note += " By the tunnelling formula, a contact of length τ is missed with the probability max(0, 1 − τ/dt)."
    return Table(f"Every setting, and the {kind.things} it saw", note, tuple(columns), tuple(rows))


def followed(arrangement: Arrangement) -> Table:
    """In free flight: until when every method shares the reference's hits, how far it is off, and what it conserves."""
    shown = [name for name in _FREE if any(point.summary(name) for point in arrangement.points)]
    units = {name: scale([point.median(name) for point in arrangement.points], metric_unit(name)) for name in shown}
    rows = []
    for series in arrangement.series:
        for point, x in zip(series.points, series.x, strict=True):
            row = [words(place_of(arrangement, series, x), series.style)]
            rows.append(tuple(row + [measured(point, name, units[name]) for name in shown]))
    columns = [Column(heading(name), units[name].symbol) for name in shown]
    note = (
        "Bodies answer their hits, so each method computes a motion of its own. It is held against the reference up to "
        "the first hit of any body that differs; places at up to 256 times until then. After that chaos leaves only "
        "what is conserved, and how often bodies hit."
    )
    return Table(
        "How long the exact motion is followed", note, (Column("Method", numeric=False), *columns), tuple(rows)
    )


def _why_not(curve: Curve) -> str:
    """Why a method does not reach an error."""
    sound = [found.error for found in curve.settings if found.sees_all_hits]
    if sound:
        return f"least error {error_text(min(sound), curve.settings[0].kind.unit)}"
    things = curve.settings[0].kind.things
    return f"{number(100 * min(found.wrong for found in curve.settings))} % of {things} wrong"


def _error(value: float) -> Entry:
    return Entry(number(value), sort=plain(value))


def _share(value: float, flagged: bool = True) -> Entry:
    if not math.isfinite(value):
        return Entry("–")
    text = f"{number(100 * value)} %"
    over = flagged and value > MOST_WRONG
    return Entry("" if over else text, flag=text if over else "", sort=plain(value))
