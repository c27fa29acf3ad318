"""What became of an expectation or a claim: holds, fails or undecided, in a sentence with its numbers.

An expectation must hold in every run, and every run it speaks of must have a result and report the metric. A claim is
about medians: it holds where the interval lies within its limits, fails where it lies outside, and is undecided where
it straddles a limit or there is too little to tell. Growth exponents and ratios are judged by their intervals for both.
With several points or groups, one failure fails the whole, and else one undecided leaves it undecided.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import pandas as pd

from harness.measure.limits import Criterion, Limits, Outcome, declared, limits, settings
from harness.measure.metrics import METRICS
from harness.measure.selection import grouped, matching, plain, tied, values, varying
from harness.measure.statistics import CONFIDENCE, Summary, fit_exponent, paired_ratio, summary

Kind = Literal["expectation", "claim"]

REJECTED = "rejected"  # the metric that says of each run whether it was refused

_ROUNDING = 1e-6  # of the exponent of an exact power law


@dataclass(frozen=True)
class GroupVerdict:
    """The verdict on one point, or on the points that one exponent was fitted to.

    Parameters
    ----------
    parameters : what sets this group apart from the others, {leaf: value}
    statement : the group's sentence, without the limits
    value, low, high : the number judged and its interval; None where there is none, or it is infinite
    n : repeats, pairs of repeats, or points of a fit
    """

    parameters: dict[str, Any]
    verdict: Outcome
    statement: str
    value: float | None
    low: float | None
    high: float | None
    n: int


@dataclass(frozen=True)
class Verdict:
    """A verdict with its sentence for people and the groups it stands on."""

    verdict: Outcome
    statement: str
    groups: tuple[GroupVerdict, ...] = ()

    @property
    def detail(self) -> dict[str, Any]:
        """The groups as plain values that JSON can hold."""
        return {"groups": [asdict(group) for group in self.groups]}


def judge(criterion: Criterion, runs: pd.DataFrame, swept: Sequence[str], kind: Kind = "expectation") -> Verdict:
    """Judge one row of `expect` or `claims` by the runs of its experiment.

    Parameters
    ----------
    criterion : the row
    runs : the run table of one experiment
    swept : the leaves that vary in it
    kind : whether the row stands in `expect` or in `claims`
    """
    if criterion.metric == REJECTED:  # a run that was refused has an answer to this, though no other
        runs = runs.assign(**{REJECTED: (runs["status"] == REJECTED).astype(float)})
        runs["status"] = runs["status"].where(runs["status"] != REJECTED, "ok")
    if criterion.metric not in runs:
        runs = runs.assign(**{criterion.metric: math.nan})
    chosen = matching(runs, criterion.where)
    if chosen.empty:
        return Verdict("undecided", f"no run{_for(criterion.where)} to judge {criterion.metric} by")
    case = _Case(criterion, limits(criterion), runs, chosen, [leaf for leaf in swept if leaf in runs], kind)
    if criterion.exponent_of is not None:
        return _folded(case, _exponents(case, criterion.exponent_of), chosen, "groups")
    if criterion.ratio_to is not None:
        return _folded(case, *_ratios(case, criterion.ratio_to), "points")
    return _folded(case, _points(case), chosen, "points")


def expected_refusals(criteria: Iterable[Criterion], runs: pd.DataFrame) -> set[tuple[str, int]]:
    """(point, repeat) of the runs that were rejected where the criteria say that they must be."""
    found: set[tuple[str, int]] = set()
    for criterion in criteria:
        if criterion.metric == REJECTED and limits(criterion).hold(1.0):
            chosen = matching(runs, criterion.where)
            chosen = chosen[chosen["status"] == REJECTED]
            found.update(zip(chosen["point"], chosen["repeat"], strict=True))
    return found


@dataclass(frozen=True)
class _Case:
    criterion: Criterion
    limits: Limits
    runs: pd.DataFrame  # all of the experiment
    chosen: pd.DataFrame  # those that match `where`
    swept: list[str]
    kind: Kind

    @property
    def metric(self) -> str:
        return self.criterion.metric

    @property
    def strict(self) -> bool:
        return self.kind == "expectation"

    @property
    def noisy(self) -> bool:
        return self.metric not in METRICS or METRICS[self.metric].noisy

    def finished(self, rows: pd.DataFrame) -> pd.DataFrame:
        finished: pd.DataFrame = rows.loc[(rows["status"] == "ok") & rows[self.metric].notna()]
        return finished


def _folded(case: _Case, groups: Sequence[GroupVerdict], used: pd.DataFrame, noun: str) -> Verdict:
    """One verdict of many: the worst decides, and is told."""
    problems = _problems(case, used)
    if not groups:
        return Verdict("undecided", f"nothing to compare {case.metric} with{_for(case.criterion.ratio_to or {})}")
    outcomes = [group.verdict for group in groups]
    outcome: Outcome = "fails" if "fails" in outcomes else "undecided" if "undecided" in outcomes else "holds"
    alike = [group for group in groups if group.verdict == outcome]
    worst = max(alike, key=lambda group: case.limits.excess(group.value))
    elsewhere = {leaf: value for leaf, value in case.criterion.where.items() if leaf not in worst.parameters}
    verb = "expected" if case.strict else "claimed"
    sentences = [f"{worst.statement}{_for(elsewhere)} ({verb} {case.limits.text})"]
    if len(groups) > 1:
        told = {"holds": "hold, this one with the least to spare", "fails": "fail", "undecided": "are undecided"}
        sentences.append(f"{len(alike)} of {len(groups)} {noun} {told[outcome]}")
    if case.strict and problems:
        return Verdict("fails", "; ".join([*problems, *sentences]), tuple(groups))
    return Verdict(outcome, "; ".join([*sentences, *problems]), tuple(groups))


def _problems(case: _Case, used: pd.DataFrame) -> list[str]:
    """What is wrong with the runs themselves: no result, or none of this metric."""
    lost = used[used["status"] != "ok"]
    blank = used[(used["status"] == "ok") & used[case.metric].isna()]
    problems = []
    if len(lost):
        counts = ", ".join(f"{count} {status}" for status, count in lost["status"].value_counts().items())
        reason = lost["reason"].iloc[0]
        told = f": {reason}" if isinstance(reason, str) else ""
        problems.append(f"{len(lost)} of {len(used)} runs have no result ({counts}; {_first(lost, used, case)}{told})")
    if len(blank):
        where = _first(blank, used, case)
        problems.append(f"{len(blank)} of {len(used)} runs report no {case.metric}, or not a number ({where})")
    return problems


def _first(rows: pd.DataFrame, among: pd.DataFrame, case: _Case) -> str:
    return settings(values(rows, [*varying(among, case.swept), "repeat"]))


def _points(case: _Case) -> list[GroupVerdict]:
    """Every point by itself: an expectation by its worst run, a claim by the interval of its median."""
    judge_point = _worst_run if case.strict else _median
    leaves = varying(case.chosen, case.swept)
    return [
        judge_point(case, values(rows, leaves), case.finished(rows))
        for _, rows in case.chosen.groupby("point", sort=False)
    ]


def _worst_run(case: _Case, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    measured = [float(value) for value in finished[case.metric]]
    if not measured:
        return _group(where, "fails", f"{case.metric}{_at(where)} has no value", summary([]))
    worst = max(measured, key=case.limits.excess)
    repeat = {"repeat": finished["repeat"].iloc[measured.index(worst)]} if len(measured) > 1 else {}
    found = Summary(worst, min(measured), max(measured), None, len(measured))
    statement = f"{case.metric}{_at(where | repeat)} is {_number(worst)}"
    return _group(where, "holds" if case.limits.hold(worst) else "fails", statement, found)


def _median(case: _Case, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    found = summary(finished[case.metric])
    outcome, remark = _judged(case, found)
    return _group(where, outcome, f"{case.metric}{_at(where)} is {_interval(found)}{remark}", found)


def _exponents(case: _Case, leaf: str) -> list[GroupVerdict]:
    """A fit for each combination of the other varying leaves; one that varies together with the leaf is no other."""
    if leaf not in case.chosen:
        statement = f"the growth of {case.metric} with {leaf} cannot be told: no run has a {leaf}"
        return [_group({}, "undecided", statement, summary([]))]
    others = [
        other
        for other in varying(case.chosen, case.swept)
        if other != leaf and not tied(case.chosen, other, leaf, case.swept)
    ]
    return [_exponent(case, leaf, where, case.finished(rows)) for where, rows in grouped(case.chosen, others)]


def _exponent(case: _Case, leaf: str, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    samples: dict[float, list[float]] = defaultdict(list)
    for x, y in zip(pd.to_numeric(finished[leaf], errors="coerce"), finished[case.metric], strict=True):
        samples[float(x)].append(float(y))
    fit = fit_exponent(samples)
    found = Summary(fit.value, fit.low, fit.high, CONFIDENCE, fit.n)
    dropped = f", without {leaf}={', '.join(map(declared, fit.dropped))} as not above 0" if fit.dropped else ""
    if not fit.enough:
        range_found = f"{fit.n} points, a factor of {_number(fit.range_factor)}" if fit.n > 1 else f"{fit.n} points"
        statement = (
            f"the growth of {case.metric} with {leaf}{_at(where)} cannot be told: "
            f"not enough range ({range_found}){dropped}"
        )
        return _group(where, "undecided", statement, found)
    outcome = case.limits.judge(fit.low, fit.high, _ROUNDING)
    power = "{:.2f} [{:.2f}, {:.2f}]".format(*(round(end, 2) + 0.0 for end in (fit.value, fit.low, fit.high)))  # no -0
    statement = f"{case.metric}{_at(where)} grows as {leaf}^{power}{dropped}{_remark(outcome)}"
    return _group(where, outcome, statement, found)


def _ratios(case: _Case, base: Mapping[str, Any]) -> tuple[list[GroupVerdict], pd.DataFrame]:
    """Every point against its partner, the point that differs just in the leaves of `base`, repeat by repeat.

    Points without a partner are left out. Returns the verdicts and all the runs that were compared.
    """
    elsewhere = {leaf: value for leaf, value in case.criterion.where.items() if leaf not in base}
    partners = matching(case.runs, {**elsewhere, **base})
    points = case.chosen[~case.chosen["point"].isin(partners["point"])]
    leaves = varying(pd.concat([points, partners]), case.swept)
    # By all runs of the experiment: among the few compared, leaves can seem to vary together by chance
    shared = [
        leaf
        for leaf in leaves
        if leaf not in base and not any(tied(case.runs, leaf, to, case.swept) for to in base if to in case.runs)
    ]
    partner_of = {tuple(where.values()): rows for where, rows in grouped(partners, shared)}
    groups, compared = [], []
    for _, rows in points.groupby("point", sort=False):
        partner = partner_of.get(tuple(values(rows, shared).values()))
        if partner is not None:
            groups.append(_ratio(case, values(rows, leaves), rows, partner, base))
            compared += [rows, partner]
    return groups, pd.concat(compared) if compared else points.iloc[:0]


def _ratio(
    case: _Case, where: dict[str, Any], rows: pd.DataFrame, partner: pd.DataFrame, base: Mapping[str, Any]
) -> GroupVerdict:
    subject = f"{case.metric}{_at(where)}"
    if partner["point"].nunique() > 1:
        statement = f"{subject} can be compared with more than one point{_for(base)}"
        return _group(where, "undecided", statement, summary([]))
    places = ["repeat", "machine"] if "machine" in rows else ["repeat"]  # times of two machines are not compared
    pairs = case.finished(rows).merge(case.finished(partner), on=places, suffixes=("", " of partner"))
    found = paired_ratio(pairs[case.metric], pairs[f"{case.metric} of partner"])
    outcome, remark = _judged(case, found)
    return _group(where, outcome, f"{subject} is {_interval(found)} times that{_for(base)}{remark}", found)


def _judged(case: _Case, found: Summary) -> tuple[Outcome, str]:
    if found.n == 0:
        return "undecided", ", as no run tells"
    if case.noisy and found.n == 1:
        return "undecided", ", from one repeat, which says nothing about its noise"
    outcome = case.limits.judge(found.low, found.high)
    return outcome, _remark(outcome)


def _remark(outcome: Outcome) -> str:
    return ", which straddles a limit" if outcome == "undecided" else ""


def _group(where: dict[str, Any], outcome: Outcome, statement: str, found: Summary) -> GroupVerdict:
    return GroupVerdict(where, outcome, statement, plain(found.median), plain(found.low), plain(found.high), found.n)


def _interval(found: Summary) -> str:
    if found.n == 0:
        return "unknown"
    if found.low == found.high:
        return _number(found.median)
    span = f"[{_number(found.low)}, {_number(found.high)}]"
    if found.coverage is None:
        return f"{_number(found.median)} (range of {found.n} repeats: {span})"
    return f"{_number(found.median)} {span}"


def _number(value: float) -> str:
    """Whole numbers in full, others to three significant digits."""
    if math.isfinite(value) and abs(value) < 1e15 and (float(value).is_integer() or abs(value) >= 1000.0):
        return f"{value:.0f}"
    return f"{value:#.3g}".removesuffix(".")


def _at(where: Mapping[str, Any]) -> str:
    return f" at {settings(where)}" if where else ""


def _for(where: Mapping[str, Any]) -> str:
    return f" for {settings(where)}" if where else ""
