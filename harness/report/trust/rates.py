"""The rates: for each kind of statement, how often it is false where nothing is different, and how often it is made."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from zlib import crc32

import numpy as np
from scipy import special

from harness.measure.statistics import fit_exponent, summary
from harness.report.sentences.crossings import crossings
from harness.report.sweeps.difference import difference_of
from harness.report.trust.invented import SWEEP, Invented, names_a_winner, report
from harness.report.trust.noise import MachineNoise, Times
from harness.store.records import RunRecord
from harness.store.snapshot import Snapshot

FILE = Path(__file__).with_name("rates.json")
NOISE = MachineNoise()
_XS = (10, 20, 40, 80)
MORE = "the more the better"
"""The rate that is wanted of what is to be found."""


@dataclass(frozen=True)
class Rate:
    """How often something came out.

    Parameters
    ----------
    kind : of statement
    what : that came out, for people
    wanted : the rate that it should have, for people
    times : it came out that often
    trials : of so many
    """

    kind: str
    what: str
    wanted: str
    times: int
    trials: int

    @property
    def share(self) -> float:
        """The rate."""
        return self.times / self.trials if self.trials else 0.0

    @property
    def most(self) -> float:
        """The largest rate that such a result allows, with 95 % confidence."""
        if self.times >= self.trials:
            return 1.0
        # of Clopper and Pearson
        return float(special.betaincinv(self.times + 1, self.trials - self.times, 0.95))

    @property
    def least(self) -> float:
        """The smallest rate that such a result allows, with 95 % confidence.

        >>> round(Rate("", "", "", 200, 200).least, 3)
        0.985
        """
        return float(special.betaincinv(self.times, self.trials - self.times + 1, 0.05)) if self.times else 0.0


# What was simulated: yields (times, trials) one trial after another, the same ones for the same seed.
Simulation = Callable[[np.random.Generator], Iterator[tuple[int, int]]]


@dataclass(frozen=True)
class Simulated:
    """One line of the table: what is counted, and how it is simulated in so many trials."""

    kind: str
    what: str
    wanted: str
    trials: int
    simulation: Simulation

    def rate(self, trials: int | None = None) -> Rate:
        """The rate over its trials, or over the first few of them; each trial has a seed of its own."""
        times = counted = 0
        for trial in range(trials or self.trials):
            for more, of in self.simulation(np.random.default_rng([trial, crc32(self.what.encode())])):
                times, counted = times + more, counted + of
        return Rate(self.kind, self.what, self.wanted, times, counted)


def simulated() -> list[Simulated]:
    """Every line of the table."""
    ahead, found, few, more = "Who is ahead", "What is found", "under 5 %", MORE
    exponents, sweeps = "Exponents", "Differences of sweeps"
    lines = [
        (ahead, "a report of 60 experiments of equal methods names a winner", few, 100, _equal_report),
        (ahead, "an experiment of two equal methods, five repeats, names a winner", few, 600, _winners([1, 1], 5)),
        (ahead, "an experiment of two equal methods, ten repeats, names a winner", few, 300, _winners([1, 1], 10)),
        (ahead, "an experiment of two equal methods, three repeats, names a winner", "0", 30, _winners([1, 1], 3)),
        (ahead, "an experiment of six equal methods, five repeats, names a winner", few, 200, _winners([1] * 6, 5)),
        (ahead, "a winner named is false, in reports where half the experiments differ", few, 20, _mixed_report),
        (ahead, "the interval of a crossing of curved costs does not hold it", few, 300, _crossings),
        ("Intervals", "the interval of five repeats does not hold the median", "6.25 %", 4000, _median(5)),
        ("Intervals", "the interval of ten repeats does not hold the median", few, 4000, _median(10)),
        (exponents, "the interval of an exponent, five repeats, does not hold it", "5 %", 2000, _exponent(5)),
        (exponents, "the interval of an exponent, ten repeats, does not hold it", "5 %", 2000, _exponent(10)),
        *(
            (sweeps, f"a sweep of the same program, {repeats}, has a slower point", few, 300, _sweeps(n, 1.0))
            for n, repeats in ((1, "1 repeat"), (3, "3 repeats"), (5, "5 repeats"), (10, "10 repeats"))
        ),
        (found, "a method 1.2 times as fast, five repeats, is named", more, 200, _winners([1, 1.2], 5)),
        (found, "a method 1.2 times as fast, ten repeats, is named", more, 200, _winners([1, 1.2], 10)),
        (found, "a method 2 times as fast, five repeats, is named", more, 200, _winners([1, 2], 5)),
        *(
            (
                found,
                f"the noisiest of twelve points, {slower} times as slow, {n} repeats, is called slower",
                more,
                200,
                _sweeps(n, slower),
            )
            for slower, n in ((1.5, 5), (1.5, 10), (2.0, 5))
        ),
    ]
    return [Simulated(*line) for line in lines]


def stored() -> list[Rate]:
    """The rates as they were simulated last."""
    return [Rate(**row) for row in json.loads(FILE.read_text(encoding="utf-8"))["rates"]]


def store() -> None:
    """Simulate all of them, and keep them."""
    rates = [asdict(line.rate()) for line in simulated()]
    FILE.write_text(json.dumps({"noise": asdict(NOISE), "rates": rates}, indent=1) + "\n", encoding="utf-8")


def _equal_report(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    experiments = [Invented(_XS[: 1 + n % 4], np.ones((2 + n % 5, 1 + n % 4))) for n in range(60)]
    yield int(any(names_a_winner(page) for page in report(experiments, rng, NOISE))), 1


def _mixed_report(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    """Of 20 experiments every other has two methods that differ by a factor of 1.5."""
    experiments = [Invented(_XS, np.array([[1.0], [1.5 if n % 2 else 1.0]]) * np.ones((2, 4))) for n in range(20)]
    named = [names_a_winner(page) for page in report(experiments, rng, NOISE)]
    yield sum(named[::2]), sum(named)


def _winners(times: Sequence[float], repeats: int) -> Simulation:
    """One experiment at four x, of methods that take these times everywhere."""

    def simulate(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
        (page,) = report([Invented(_XS, np.outer(times, np.ones(4)), repeats)], rng, NOISE)
        yield int(names_a_winner(page)), 1

    return simulate


def _crossings(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    """Every pair, against a method that pays a constant for its cells besides, at eight x; they cross at a random x."""
    xs = tuple(5 * 2**k for k in range(8))
    at = float(np.exp(rng.uniform(np.log(10.0), np.log(320.0))))
    x = np.array(xs, dtype=float)
    share = rng.uniform(0.2, 0.9)  # of the constant at the crossing
    curved = at**2 * (share + (1.0 - share) * (x / at) ** 1.2)
    (page,) = report([Invented(xs, np.array([x**2, curved]) * 1e-5)], rng, NOISE)
    for *_, crossing in crossings(page.arrangement):
        if crossing.after is not None:
            yield int(not crossing.after <= at <= crossing.by), 1


def _median(repeats: int) -> Simulation:
    def simulate(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
        found = summary(rng.lognormal(0.0, 0.3, repeats))
        yield int(not found.low <= 1.0 <= found.high), 1

    return simulate


def _exponent(repeats: int) -> Simulation:
    def simulate(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
        x = np.array([5.0, 10.0, 20.0, 40.0, 80.0])
        times = x**1.7 * NOISE.factors(rng, repeats, np.linspace(0.0, 1.0, len(x)))
        found = fit_exponent({float(at): list(column) for at, column in zip(x, times.T, strict=True)})
        yield int(not found.low <= 1.7 <= found.high), 1

    return simulate


def _sweeps(repeats: int, slower: float) -> Simulation:
    """Twelve points swept twice, the machine 15 % slower the second time; the first point is slower by a factor."""

    def simulate(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
        lengths = np.tile(np.linspace(0.0, 1.0, 4), 3)
        sweeps = [NOISE.factors(rng, repeats, lengths) for _ in range(2)]
        sweeps[1] *= 1.15
        sweeps[1][:, 0] *= slower
        old, new = (_snapshot(number, times) for number, times in enumerate(sweeps))
        paces = [point.pace for point in difference_of(SWEEP, SWEEP, old, new).points if point.pace == "slower"]
        yield int(bool(paces)), 1

    return simulate


def _snapshot(sweep: int, times: Times) -> Snapshot:
    runs = tuple(
        RunRecord("e", f"p{place}", repeat, "ok", None, sweep, True, {"count": place}, {"run_seconds": float(seconds)})
        for repeat, row in enumerate(times)
        for place, seconds in enumerate(row)
    )
    return Snapshot(runs, {}, ())
