"""What became of an expectation or a claim: holds, fails or undecided, in a sentence with its numbers.

An expectation must hold in every run, and every run it speaks of must have a result and report the metric. A claim is
about medians: it holds where the interval lies within its limits, fails where it lies outside, and is undecided where
it straddles a limit or there is too little to tell. Growth exponents and ratios are judged by their intervals for both;
a ratio of clocks needs five pairs of repeats and a control, whose noise floor widens its interval. With several points
or groups, one failure fails the whole, and else one undecided leaves it undecided.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

from harness.measure.limits import Criterion, Limits, VerdictWord, declared, leaves_text, limits
from harness.measure.metrics import METRICS
from harness.measure.noise import Control
from harness.measure.number_text import interval_text, number_text
from harness.measure.selection import grouped, matching, plain, tied, values, varying
from harness.measure.statistics import CONFIDENCE, FEWEST_FOR_INTERVAL, Summary, fit_exponent, paired_ratio, summary

if TYPE_CHECKING:
    import pandas as pd

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
    verdict: VerdictWord
    statement: str
    value: float | None
    low: float | None
    high: float | None
    n: int


@dataclass(frozen=True)
class Verdict:
    """A verdict with its sentence for people and the groups it stands on."""

    verdict: VerdictWord
    statement: str
    groups: tuple[GroupVerdict, ...] = ()

    @property
    def detail(self) -> dict[str, Any]:
        """The groups as plain values that JSON can hold."""
        return {"groups": [asdict(group) for group in self.groups]}


def verdict_on(
    criterion: Criterion,
    runs: pd.DataFrame,
    swept: Sequence[str],
    kind: Kind = "expectation",
    controls: Mapping[str, Control] | None = None,
) -> Verdict:
    """Judge one row of `expect` or `claims` by the runs of its experiment.

    Parameters
    ----------
    criterion : the row
    runs : the run table of one experiment
    swept : the leaves that vary in it
    kind : whether the row stands in `expect` or in `claims`
    controls : of the experiment, by clock; None where it is not known whether there are any
    """
    if criterion.metric == REJECTED:  # a run that was refused has an answer to this, though no other
        runs = runs.assign(**{REJECTED: (runs["status"] == REJECTED).astype(float)})
        runs["status"] = runs["status"].where(runs["status"] != REJECTED, "ok")
    if criterion.metric not in runs:
        runs = runs.assign(**{criterion.metric: math.nan})
    chosen = matching(runs, criterion.where)
    if chosen.empty:
        return Verdict("undecided", f"no run{_for(criterion.where)} to judge {criterion.metric} by")
    leaves = [leaf for leaf in swept if leaf in runs]
    basis = _Basis(criterion, limits(criterion), runs, chosen, leaves, kind, controls)
    if criterion.exponent_of is not None:
        return _combined(basis, _exponents(basis, criterion.exponent_of), chosen, "groups")
    if criterion.ratio_to is not None:
        return _combined(basis, *_ratios(basis, criterion.ratio_to), "points")
    return _combined(basis, _points(basis), chosen, "points")


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
class _Basis:
    """A criterion, and the runs that it is judged by."""

    criterion: Criterion
    limits: Limits
    runs: pd.DataFrame  # all of the experiment
    chosen: pd.DataFrame  # those that match `where`
    swept: list[str]
    kind: Kind
    controls: Mapping[str, Control] | None

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


def _combined(basis: _Basis, groups: Sequence[GroupVerdict], used: pd.DataFrame, noun: str) -> Verdict:
    """One verdict of many: the worst decides, and its sentence is given."""
    problems = _problems(basis, used)
    if not groups:
        return Verdict("undecided", f"nothing to compare {basis.metric} with{_for(basis.criterion.ratio_to or {})}")
    outcomes = [group.verdict for group in groups]
    outcome: VerdictWord = "fails" if "fails" in outcomes else "undecided" if "undecided" in outcomes else "holds"
    alike = [group for group in groups if group.verdict == outcome]
    worst = max(alike, key=lambda group: basis.limits.excess(group.value))
    elsewhere = {leaf: value for leaf, value in basis.criterion.where.items() if leaf not in worst.parameters}
    verb = "expected" if basis.strict else "claimed"
    sentences = [f"{worst.statement}{_for(elsewhere)} ({verb} {basis.limits.text})"]
    if len(groups) > 1:
        phrases = {"holds": "hold, this one with the least to spare", "fails": "fail", "undecided": "are undecided"}
        sentences.append(f"{len(alike)} of {len(groups)} {noun} {phrases[outcome]}")
    if basis.strict and problems:
        return Verdict("fails", "; ".join([*problems, *sentences]), tuple(groups))
    return Verdict(outcome, "; ".join([*sentences, *problems]), tuple(groups))


def _problems(basis: _Basis, used: pd.DataFrame) -> list[str]:
    """What is wrong with the runs themselves: no result, or none of this metric."""
    unfinished = used[used["status"] != "ok"]
    unreported = used[(used["status"] == "ok") & used[basis.metric].isna()]
    problems = []
    if len(unfinished):
        counts = ", ".join(f"{count} {status}" for status, count in unfinished["status"].value_counts().items())
        reason = unfinished["reason"].iloc[0]
        why = f": {reason}" if isinstance(reason, str) else ""
        problems.append(
            f"{len(unfinished)} of {len(used)} runs have no result ({counts}; {_first(unfinished, used, basis)}{why})"
        )
    if len(unreported):
        where = _first(unreported, used, basis)
        problems.append(f"{len(unreported)} of {len(used)} runs report no {basis.metric}, or not a number ({where})")
    return problems


def _first(rows: pd.DataFrame, among: pd.DataFrame, basis: _Basis) -> str:
    return leaves_text(values(rows, [*varying(among, basis.swept), "repeat"]))


def _points(basis: _Basis) -> list[GroupVerdict]:
    """Every point by itself: an expectation by its worst run, a claim by the interval of its median."""
    judge_point = _worst_run if basis.strict else _median
    leaves = varying(basis.chosen, basis.swept)
    return [
        judge_point(basis, values(rows, leaves), basis.finished(rows))
        for _, rows in basis.chosen.groupby("point", sort=False)
    ]


def _worst_run(basis: _Basis, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    measured = [float(value) for value in finished[basis.metric]]
    if not measured:
        return _group(where, "fails", f"{basis.metric}{_at(where)} has no value", summary([]))
    worst = max(measured, key=basis.limits.excess)
    repeat = {"repeat": finished["repeat"].iloc[measured.index(worst)]} if len(measured) > 1 else {}
    found = Summary(worst, min(measured), max(measured), None, len(measured))
    statement = f"{basis.metric}{_at(where | repeat)} is {number_text(worst)}"
    return _group(where, "holds" if basis.limits.hold(worst) else "fails", statement, found)


def _median(basis: _Basis, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    found = summary(finished[basis.metric])
    outcome, remark = _judged(basis, found)
    return _group(where, outcome, f"{basis.metric}{_at(where)} is {interval_text(found)}{remark}", found)


def _exponents(basis: _Basis, leaf: str) -> list[GroupVerdict]:
    """A fit for each combination of the other varying leaves; one that varies together with the leaf is no other."""
    if leaf not in basis.chosen:
        statement = f"the growth of {basis.metric} with {leaf} cannot be told: no run has a {leaf}"
        return [_group({}, "undecided", statement, summary([]))]
    others = [
        other
        for other in varying(basis.chosen, basis.swept)
        if other != leaf and not tied(basis.chosen, other, leaf, basis.swept)
    ]
    return [_exponent(basis, leaf, where, basis.finished(rows)) for where, rows in grouped(basis.chosen, others)]


def _exponent(basis: _Basis, leaf: str, where: dict[str, Any], finished: pd.DataFrame) -> GroupVerdict:
    import pandas as pd

    samples: dict[float, list[float]] = defaultdict(list)
    for x, y in zip(pd.to_numeric(finished[leaf], errors="coerce"), finished[basis.metric], strict=True):
        samples[float(x)].append(float(y))
    fit = fit_exponent(samples)
    found = Summary(fit.value, fit.low, fit.high, CONFIDENCE, fit.n)
    dropped = f", without {leaf}={', '.join(map(declared, fit.dropped))} as not above 0" if fit.dropped else ""
    if not fit.enough:
        range_found = f"{fit.n} points, a factor of {number_text(fit.range_factor)}" if fit.n > 1 else f"{fit.n} points"
        statement = (
            f"the growth of {basis.metric} with {leaf}{_at(where)} cannot be told: "
            f"not enough range ({range_found}){dropped}"
        )
        return _group(where, "undecided", statement, found)
    outcome = basis.limits.judge(fit.low, fit.high, _ROUNDING)
    power = "{:.2f} [{:.2f}, {:.2f}]".format(*(round(end, 2) + 0.0 for end in (fit.value, fit.low, fit.high)))  # no -0
    statement = f"{basis.metric}{_at(where)} grows as {leaf}^{power}{dropped}{_remark(outcome)}"
    return _group(where, outcome, statement, found)


def _ratios(basis: _Basis, base: Mapping[str, Any]) -> tuple[list[GroupVerdict], pd.DataFrame]:
    """Every point against its partner, the point that differs just in the leaves of `base`, repeat by repeat.

    Points without a partner are left out. Returns the verdicts and all the runs that were compared.
    """
    import pandas as pd

    elsewhere = {leaf: value for leaf, value in basis.criterion.where.items() if leaf not in base}
    partners = matching(basis.runs, {**elsewhere, **base})
    points = basis.chosen[~basis.chosen["point"].isin(partners["point"])]
    leaves = varying(pd.concat([points, partners]), basis.swept)
    # By all runs of the experiment: among the few compared, leaves can seem to vary together by chance
    shared = [
        leaf
        for leaf in leaves
        if leaf not in base and not any(tied(basis.runs, leaf, to, basis.swept) for to in base if to in basis.runs)
    ]
    partner_of = {tuple(where.values()): rows for where, rows in grouped(partners, shared)}
    groups, compared = [], []
    for _, rows in points.groupby("point", sort=False):
        partner = partner_of.get(tuple(values(rows, shared).values()))
        if partner is not None:
            groups.append(_ratio(basis, values(rows, leaves), rows, partner, base))
            compared += [rows, partner]
    return groups, pd.concat(compared) if compared else points.iloc[:0]


def _ratio(
    basis: _Basis, where: dict[str, Any], rows: pd.DataFrame, partner: pd.DataFrame, base: Mapping[str, Any]
) -> GroupVerdict:
    subject = f"{basis.metric}{_at(where)}"
    if partner["point"].nunique() > 1:
        statement = f"{subject} can be compared with more than one point{_for(base)}"
        return _group(where, "undecided", statement, summary([]))
    places = ["repeat", "machine"] if "machine" in rows else ["repeat"]  # times of two machines are not compared
    pairs = basis.finished(rows).merge(basis.finished(partner), on=places, suffixes=("", " of partner"))
    found = paired_ratio(pairs[basis.metric], pairs[f"{basis.metric} of partner"])
    outcome, remark = _judged_ratio(basis, found)
    return _group(where, outcome, f"{subject} is {interval_text(found)} times that{_for(base)}{remark}", found)


def _judged_ratio(basis: _Basis, found: Summary) -> tuple[VerdictWord, str]:
    """As `_judged`; of a clock, only with repeats and a control enough, and beyond its noise floor."""
    if not basis.noisy or found.n == 0:
        return _judged(basis, found)
    if found.n < FEWEST_FOR_INTERVAL:
        return "undecided", f", from too few pairs of repeats to judge (fewer than {FEWEST_FOR_INTERVAL})"
    if basis.controls is None:
        return _judged(basis, found)
    control = basis.controls.get(basis.metric)
    if control is None:
        return "undecided", ", without a control to judge its noise by"
    outcome = basis.limits.judge(found.low / (1.0 + control.floor), found.high * (1.0 + control.floor))
    remark = f", which straddles a limit by less than the noise floor of {100 * control.floor:.2g} %"
    plain_outcome, plain_remark = _judged(basis, found)
    return outcome, remark if outcome != plain_outcome else plain_remark


def _judged(basis: _Basis, found: Summary) -> tuple[VerdictWord, str]:
    if found.n == 0:
        return "undecided", ", as no run tells"
    if basis.noisy and found.n == 1:
        return "undecided", ", from one repeat, which says nothing about its noise"
    outcome = basis.limits.judge(found.low, found.high)
    return outcome, _remark(outcome)


def _remark(outcome: VerdictWord) -> str:
    return ", which straddles a limit" if outcome == "undecided" else ""


def _group(where: dict[str, Any], outcome: VerdictWord, statement: str, found: Summary) -> GroupVerdict:
    return GroupVerdict(where, outcome, statement, plain(found.median), plain(found.low), plain(found.high), found.n)


def _at(where: Mapping[str, Any]) -> str:
    return f" at {leaves_text(where)}" if where else ""


def _for(where: Mapping[str, Any]) -> str:
    return f" for {leaves_text(where)}" if where else ""
