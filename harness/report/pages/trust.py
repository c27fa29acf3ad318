"""How far to trust the statements of a report: what is asked of each, and how often each is false by simulation."""

from __future__ import annotations

from itertools import groupby

from harness.measure.noise import FALSE_RATE
from harness.measure.statistics import FEWEST_FOR_INTERVAL
from harness.report.page import Content, Page
from harness.report.quantity import number, plural
from harness.report.results import Results
from harness.report.table import Column, Entry, Table, plain, words
from harness.report.trust.rates import MORE, NOISE, Rate, stored

FILE = "trust.html"


def _content(results: Results) -> Content | None:
    if not results.pages:
        return None
    rates = stored()
    values = {
        "family": _family(results),
        "tables": [_table(kind, list(found)) for kind, found in groupby(rates, key=lambda rate: rate.kind)],
        "noise": NOISE,
        "fewest": FEWEST_FOR_INTERVAL,
        "rate": f"{100 * FALSE_RATE:g}\u00a0%",
    }
    return Content("trust.html.j2", values, results.records)


def _family(results: Results) -> str:
    """How many comparisons this report looks at, and what level they are held to."""
    family = results.family
    if not family.p_values:
        return "This report compares nothing for which it has repeats and a control."
    counted = sum(p <= family.level for p in family.p_values)
    if not counted:
        return f"This report looks at {plural(len(family.p_values), 'comparison')}, and none of them counts."
    return (
        f"This report looks at {plural(len(family.p_values), 'comparison')}; {number(counted)} of them, those of a "
        f"p-value of at most {number(family.level)}, count as differences where they lie beyond the noise floor too."
    )


def _table(kind: str, rates: list[Rate]) -> Table:
    much = all(rate.wanted == MORE for rate in rates)
    rows = tuple(
        (
            words(rate.what),
            Entry(f"{number(100 * rate.share)} %", sort=plain(rate.share)),
            Entry(f"{number(100 * bound)} %", sort=plain(bound)),
            Entry(f"{number(rate.times)} of {number(rate.trials)}", sort=plain(rate.trials)),
            words(rate.wanted),
        )
        for rate, bound in ((rate, rate.least if much else rate.most) for rate in rates)
    )
    columns = (
        Column("How often", numeric=False), Column("rate"), Column("at least" if much else "at most"),
        Column("counted"), Column("should be", numeric=False),
    )  # fmt: skip
    way, size = ("least", "smallest") if much else ("most", "largest")
    note = f"“At {way}” is the {size} rate that such a count allows, with 95 % confidence."
    return Table(kind, note, columns, rows)


PAGE = Page(FILE, "Trust", 50, _content)
