"""Numbers from repeats: medians with the interval that they really have, paired ratios and growth exponents.

Intervals of medians come from order statistics and so ask nothing of the noise but independence. With five repeats they
are the range, which covers the true median with probability 1 - 2/2^5 = 93.75 %; fewer repeats have a range and no
interval. Nothing here is random: the same values give the same numbers.

scipy is imported by what calls it: its `special` takes a third of a second, which a sweep that judges nothing need not
spend, and its `stats` as long as a small report.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

CONFIDENCE = 0.95
FEWEST_FOR_INTERVAL = 5
NOISY_ABOVE = 0.05  # half an interval, of the median
# In scaled median absolute deviations. Of clean samples of five, the usual three would flag every fourth; five flag one
# in nine.
OUTLIER_BEYOND = 5.0
ENOUGH_RANGE = 8.0  # largest x / smallest x
FEWEST_FOR_EXPONENT = 3

_MEDIAN_TO_MEAN = math.pi / 2.0  # variance of a median to that of a mean, of normal noise
_CONSTANT = 1e-12  # what varies by less, relatively, varies by rounding
_SCALED = 1.0 / NormalDist().inv_cdf(0.75)  # makes a median absolute deviation a standard deviation of normal noise


@dataclass(frozen=True)
class Summary:
    """Repeats of one number.

    Parameters
    ----------
    median : NaN where there is no value
    low, high : the interval of the median; below five values their range
    coverage : probability that such an interval holds the true median; None below five values
    n : values counted
    outliers : places, in the values given, of those off the median by more than five scaled median absolute deviations
        and by more than 5 % of it. They are flagged, and count like all others.
    missing : values that were NaN, and do not count
    """

    median: float
    low: float
    high: float
    coverage: float | None
    n: int
    outliers: tuple[int, ...] = ()
    missing: int = 0

    @property
    def spread(self) -> float:
        """Half the interval, of the median; 0 where all values are the same."""
        half = (self.high - self.low) / 2.0
        if half == 0.0:
            return 0.0
        return half / abs(self.median) if self.median else math.inf

    @property
    def precise(self) -> bool | None:
        """Whether the spread is at most 5 %; None below five values, where it cannot be said."""
        return None if self.coverage is None else self.spread <= NOISY_ABOVE


@dataclass(frozen=True)
class Exponent:
    """The power of x that y grows with: y ~ x^value.

    Parameters
    ----------
    value : NaN below two usable points
    low, high : the 95 % interval of the slope; NaN below three usable points
    r2 : share of the variance of log y that the power law explains
    range_factor : largest usable x / smallest
    n : usable points
    dropped : the x that have no place on logarithmic axes: x or median y not above 0
    """

    value: float
    low: float
    high: float
    r2: float
    range_factor: float
    n: int
    dropped: tuple[float, ...] = ()

    @property
    def enough(self) -> bool:
        """Whether there is range enough to speak of growth: three points, and a factor of 8 in x."""
        return self.n >= FEWEST_FOR_EXPONENT and self.range_factor >= ENOUGH_RANGE * (1.0 - 1e-9)


def summary(values: ArrayLike) -> Summary:
    """The median of repeats, with the narrowest symmetric pair of order statistics that covers it 95 times in 100.

    >>> found = summary([1.02, 0.99, 1.00, 1.01, 1.30])
    >>> found.median, found.low, found.high, found.coverage, found.outliers
    (1.01, 0.99, 1.3, 0.9375, (4,))
    >>> summary([3.0, 1.0, 2.0]).coverage is None  # too few for an interval: low and high are the range
    True
    """
    given = np.asarray(values, dtype=float).ravel()
    absent = np.isnan(given)
    missing = int(np.count_nonzero(absent))
    counted = np.sort(given[~absent] if missing else given)
    n = len(counted)
    if n == 0:
        return Summary(math.nan, math.nan, math.nan, None, 0, missing=missing)
    median = _middle(counted)
    if n < FEWEST_FOR_INTERVAL:
        return Summary(median, float(counted[0]), float(counted[-1]), None, n, missing=missing)
    place, coverage = interval_place(n)
    return Summary(
        median, float(counted[place]), float(counted[-1 - place]), coverage, n, _outliers(given, median), missing
    )


def median(values: ArrayLike) -> float:
    """The median alone, of those that are not NaN; NaN of none."""
    given = np.asarray(values, dtype=float).ravel()
    counted = np.sort(given[~np.isnan(given)])
    return _middle(counted) if counted.size else math.nan


def paired_ratio(a: ArrayLike, b: ArrayLike) -> Summary:
    """The ratio a/b of repeats that belong together by their place: what they share of the noise cancels.

    Parameters
    ----------
    a, b : equally many values. Where one is NaN, or both are 0, the pair counts as missing.

    Raises
    ------
    ValueError
        The lengths differ.

    Examples
    --------
    What slows both of a pair alike, as the third here, cancels:

    >>> found = paired_ratio([2.0, 2.2, 4.0, 2.0, 1.8], [1.0, 1.1, 2.0, 1.0, 0.9])
    >>> found.median, found.low, found.high
    (2.0, 2.0, 2.0)
    """
    return summary(paired_ratios(a, b))


def paired_ratios(a: ArrayLike, b: ArrayLike) -> NDArray[np.float64]:
    """The ratios a/b themselves, one a pair; NaN where one is NaN, or both are 0.

    Raises
    ------
    ValueError
        The lengths differ.
    """
    numerator, denominator = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if numerator.shape != denominator.shape:
        raise ValueError(f"{numerator.size} values cannot be paired with {denominator.size}")
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios: NDArray[np.float64] = numerator / denominator
    return ratios


def fit_exponent(samples: Mapping[float, Sequence[float]]) -> Exponent:
    """How y grows with x: least squares through the medians on logarithmic axes.

    The interval is Student's, of the slopes that the repeats have by themselves: each repeat is a measurement of its
    own, so that it holds however much noisier one x is than another. It is widened to Student's of the scatter of the
    medians about the line where that says more than the noise can explain, for then the growth is no power law; and
    where there is one value an x, as of counters, which have no noise. A counter that follows a power law exactly has
    an interval without width.

    Parameters
    ----------
    samples : {x: repeats of y there, in the order of the repeats}; NaN among them do not count, and an x without any
        is left out

    Examples
    --------
    >>> pairs = {count: [count * (count - 1) / 2] for count in (10, 20, 40, 80)}
    >>> growth = fit_exponent(pairs)
    >>> f"{growth.value:.2f} [{growth.low:.2f}, {growth.high:.2f}]", growth.enough
    ('2.04 [2.00, 2.08]', True)
    """
    medians = {float(x): median(values) for x, values in samples.items()}
    medians = {x: y for x, y in sorted(medians.items()) if math.isfinite(x) and math.isfinite(y)}
    usable = {x: y for x, y in medians.items() if x > 0.0 and y > 0.0}
    dropped = tuple(x for x in medians if x not in usable)
    n = len(usable)
    if n < 2:
        return Exponent(math.nan, math.nan, math.nan, math.nan, 1.0 if n else math.nan, n, dropped)
    x, y = np.array(list(usable)), np.array(list(usable.values()))
    log_x, log_y = np.log(x), np.log(y)
    range_factor = float(x[-1] / x[0])
    if np.ptp(log_y) < _CONSTANT:  # constants have no correlation, but the power 0 explains them wholly
        end = 0.0 if n > 2 else math.nan
        return Exponent(0.0, end, end, 1.0, range_factor, n, dropped)
    slope, scatter, explained = _line(log_x, log_y)
    low, high = _slope_interval(log_x, log_y, slope, scatter, _by_repeat(samples, usable))
    return Exponent(slope, low, high, explained, range_factor, n, dropped)


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float, float]:
    """Of the line through points by least squares: its slope, the standard error of that, and r²."""
    off_x, off_y = x - x.mean(), y - y.mean()
    along, both, across = float(off_x @ off_x), float(off_x @ off_y), float(off_y @ off_y)
    explained = min(1.0, both * both / (along * across))
    left = max(0, len(x) - 2)
    scatter = math.sqrt((1.0 - explained) * across / along / left) if left else 0.0
    return both / along, scatter, explained


def _slope_interval(
    log_x: NDArray[np.float64],
    log_y: NDArray[np.float64],
    slope: float,
    scatter: float,
    repeats: NDArray[np.float64] | None,
) -> tuple[float, float]:
    """The 95 % interval of a slope; NaN below three points.

    Parameters
    ----------
    log_x, log_y : of the medians, (k,)
    slope, scatter : of the line through them, and its standard error by how they scatter about it
    repeats : (n, k) logarithms of y, a row a repeat; None where there is one an x
    """
    k = len(log_x)
    if k < FEWEST_FOR_EXPONENT:
        return math.nan, math.nan
    half = _student(k - 2) * scatter
    if repeats is None:
        return slope - half, slope + half
    n = len(repeats)
    centred = log_x - log_x.mean()
    slopes = repeats @ centred / float(centred @ centred)
    middle, error = float(slopes.mean()), float(slopes.std(ddof=1)) / math.sqrt(n)
    low, high = middle - _student(n - 1) * error, middle + _student(n - 1) * error
    if _is_no_power_law(log_y - slope * centred - log_y.mean(), repeats):
        low, high = min(low, slope - half), max(high, slope + half)
    return min(low, slope), max(high, slope)


def _is_no_power_law(residuals: NDArray[np.float64], repeats: NDArray[np.float64]) -> bool:
    """Whether medians lie farther off a line than their own noise explains, by an F test at 1 %."""
    from scipy import special

    n, k = repeats.shape
    # what slows a whole repeat moves its line and bends none
    noise = (repeats - repeats.mean(axis=1, keepdims=True)).var(axis=0, ddof=1) / n
    if not noise.any():
        return True
    excess = residuals**2 / np.maximum(noise, noise.max() * 1e-12)
    ratio = float(excess.sum()) / (k - 2)
    return bool(ratio > _MEDIAN_TO_MEAN * special.fdtri(k - 2, n - 1, 0.99))


def _by_repeat(samples: Mapping[float, Sequence[float]], xs: Collection[float]) -> NDArray[np.float64] | None:
    """Logarithms of y, a row a repeat and a column an x, of the first repeats that all have; None below two."""
    ordered = {float(x): [v for v in values if v > 0.0] for x, values in samples.items() if float(x) in xs}
    fewest = min(len(values) for values in ordered.values())
    if fewest < 2:
        return None
    logs: NDArray[np.float64] = np.log(np.array([ordered[x][:fewest] for x in xs], dtype=float))
    return np.ascontiguousarray(logs.T)


@lru_cache(maxsize=256)
def _student(freedom: int) -> float:
    """How many standard errors an interval reaches to either side."""
    from scipy import special

    return float(special.stdtrit(freedom, (1.0 + CONFIDENCE) / 2.0))


def geometric_mean(values: ArrayLike) -> float:
    """The mean of ratios: it makes no difference which of the two is the numerator.

    Raises
    ------
    ValueError
        There is no value, or one that is not above 0 or not finite.

    Examples
    --------
    >>> f"{geometric_mean([0.5, 2.0]):.3f}"
    '1.000'
    """
    given = np.asarray(values, dtype=float)
    if given.size == 0 or not np.all(np.isfinite(given) & (given > 0.0)):
        raise ValueError("a geometric mean needs finite numbers above 0")
    return float(np.exp(np.log(given).mean()))


@lru_cache(maxsize=256)
def interval_place(n: int) -> tuple[int, float]:
    """Of five values or more, the place k of those that bound the median, x[k] and x[n - 1 - k], and their coverage."""
    from scipy import special

    # P(fewer than k + 1 of n values lie below the median) is binomial; both sides may miss half of 5 %
    enough = next(k for k in range(n + 1) if special.bdtr(k, n, 0.5) >= (1.0 - CONFIDENCE) / 2.0)
    place = max(0, enough - 1)
    return place, float(1.0 - 2.0 * special.bdtr(place, n, 0.5))


def _middle(ascending: NDArray[np.float64]) -> float:
    """The median of values in order, none of them NaN: what `np.median` gives, at a tenth of its time."""
    n = len(ascending)
    low, high = float(ascending[(n - 1) // 2]), float(ascending[n // 2])
    return low if n % 2 else (low + high) / 2.0


def _outliers(values: NDArray[np.float64], median: float) -> tuple[int, ...]:
    with np.errstate(invalid="ignore"):
        deviations = np.abs(values - median)
    # scipy's median_abs_deviation takes ten times as long as all the rest
    noise = _middle(np.sort(deviations[~np.isnan(deviations)])) * _SCALED if math.isfinite(median) else math.inf
    limit = max(OUTLIER_BEYOND * noise, NOISY_ABOVE * abs(median))
    return tuple(np.flatnonzero(deviations > limit).tolist())
