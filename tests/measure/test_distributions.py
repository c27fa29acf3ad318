"""What is computed of distributions is what scipy.stats says, which is not imported: that alone takes half a second."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from harness.measure import noise, statistics
from harness.report.trust.rates import Rate


@pytest.fixture(scope="module")
def stats():
    """Imported when a test asks for it, so that other tests need not wait."""
    from scipy import stats

    return stats


@pytest.mark.parametrize("n", [5, 6, 7, 9, 12, 20, 31, 64, 200])
def test_the_place_of_an_interval_and_its_coverage(stats, n):
    place = max(0, int(stats.binom.ppf((1.0 - statistics.CONFIDENCE) / 2.0, n, 0.5)) - 1)
    assert statistics.interval_place(n) == (place, pytest.approx(1.0 - 2.0 * stats.binom.cdf(place, n, 0.5), abs=1e-14))


@pytest.mark.parametrize("freedom", [1, 2, 3, 10, 100])
def test_how_far_an_interval_reaches(stats, freedom):
    assert statistics._student(freedom) == pytest.approx(stats.t.ppf((1.0 + statistics.CONFIDENCE) / 2.0, freedom))


points = st.lists(st.tuples(st.integers(-1000, 1000), st.integers(-1000, 1000)), min_size=2, max_size=12)


@given(points)
def test_a_line_through_points(stats, given):
    x, y = np.array(given, dtype=float).T / 64.0
    assume(np.ptp(x) > 0 and np.ptp(y) > 0)
    fit = stats.linregress(x, y)
    slope, scatter, explained = statistics._line(x, y)
    assert slope == pytest.approx(fit.slope, rel=1e-9, abs=1e-12)
    assert explained == pytest.approx(fit.rvalue**2, abs=1e-12)
    if len(x) > 2:  # two points have no scatter about their line; SciPy has said 0 and not a number
        assert scatter == pytest.approx(fit.stderr, rel=1e-6, abs=1e-6)


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=50))
def test_the_level_of_false_discoveries(stats, p_values):
    kept = np.sort(p_values)[stats.false_discovery_control(np.sort(p_values)) <= noise.FALSE_RATE]
    assert noise.level(p_values) == (float(kept[-1]) if len(kept) else 0.0)


@pytest.mark.parametrize("n", [5, 6, 9, 15])
@pytest.mark.parametrize("controls", [5, 8, 40, 150])
def test_the_chance_that_equal_pairs_lie_so_far_out(stats, n, controls):
    for place in range(n // 2):
        nearer = np.arange(place + 1)
        on_one_side = stats.binom.sf(n - place - 1, n - nearer, 0.5)
        for beyond in (0, 1, 2, controls // 2, controls):
            chances = stats.nhypergeom.pmf(nearer, n + controls, n, beyond) if beyond else nearer == 0
            expected = min(1.0, 2.0 * float(np.sum(chances * on_one_side)))
            assert noise._chance(n, place, controls, beyond) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("times", "trials"), [(0, 10), (3, 100), (99, 100), (100, 100)])
def test_the_largest_rate_that_a_result_allows(stats, times, trials):
    theirs = stats.binomtest(times, trials, alternative="less").proportion_ci(0.95, "exact").high
    assert Rate("claim", "false", "5 %", times, trials).most == pytest.approx(theirs)


@pytest.mark.slow
def test_a_report_imports_nothing_that_it_can_do_without():
    heavy = ("scipy.stats", "matplotlib", "trimesh")
    check = f"import sys, harness.report.site; print([name for name in {heavy} if name in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"
