"""The page of errors against run time, from invented runs whose answers can be told beforehand."""

import re

import pytest

from harness.report.results import Results
from harness.report.site import render
from harness.report.styles import style_of
from tests.report.conftest import Invented, write
from tests.report.test_site import Outline

STEPS = [1 / 15, 1 / 60, 1 / 250, 1 / 1000, 1 / 4000]
TRUST = 1e-14


def invented(parameters, repeat, metrics):
    """Frames cost their number and err by half a step; an event-driven method costs 20 ms and errs by nothing."""
    dt, algorithm = parameters["dt"], parameters["algorithm"]
    cost, error = {
        "brute-force": (1e-3 / dt, dt / 2),
        "grid": (1e-4 / dt, dt / 2),
        "tree": (1e-5 / dt, dt / 4),
        "predictive": (2e-2, 0.0),
    }[algorithm]
    wrong = 0.3 if algorithm == "tree" else 0.004 if dt > 0.05 else 0.0
    metrics |= {
        "run_seconds": cost * (1 + 0.01 * repeat), "time_error": error, "time_error_95": 2 * error,
        "missed_hits": wrong, "extra_hits": 0.0, "reference_hits": 500.0, "reference_error": TRUST,
    }  # fmt: skip


ACCURACY = Invented(
    "accuracy/spheres", "Error & time", {"algorithm": ["brute-force", "grid", "tree", "predictive"], "dt": STEPS},
    {"shape": "sphere", "response": "none"}, fate=invented, reference={"algorithm": "predictive", "tolerance": 1e-10},
)  # fmt: skip


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return write(tmp_path_factory.mktemp("accuracy") / "results.db", [ACCURACY])


@pytest.fixture(scope="module")
def pages(results):
    return dict(render(results))


@pytest.fixture(scope="module")
def tradeoff(results):
    (accuracy,) = Results(results).accuracy
    (found,) = accuracy.tradeoffs
    return found


def text_of(html):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", html))


def test_each_method_is_a_curve_over_its_knob_the_cheapest_setting_first(tradeoff):
    assert [method.label for method in tradeoff.curves] == ["fcl brute-force", "own grid", "fcl tree", "own predictive"]
    for method in tradeoff.curves[:3]:
        assert [setting.knob for setting in method.settings] == STEPS


def test_the_cheapest_setting_that_is_right_enough_is_chosen(tradeoff):
    _, grid, tree, predictive = tradeoff.curves
    assert grid.cheapest(1e-1).knob == 1 / 15
    assert grid.cheapest(1e-2).knob == 1 / 60
    assert grid.cheapest(1e-3).knob == 1 / 1000
    assert grid.cheapest(1e-4) is None
    assert predictive.cheapest(1e-6) is not None
    assert tree.cheapest(1e-1) is None, "it misses a third of the hits"
    assert [method.label for method, _ in tradeoff.ranked(1e-2)] == ["own grid", "own predictive", "fcl brute-force"]


def test_the_front_has_what_nothing_beats_and_nothing_that_misses_hits(tradeoff):
    labels = {id(setting): method.label for method, setting in tradeoff.settings}
    assert [labels[id(setting)] for setting in tradeoff.front] == ["own grid", "own grid", "own predictive"]
    assert tradeoff.front[-1].shown == TRUST


def test_the_order_of_frames_is_one_and_what_misses_hits_has_none(tradeoff):
    _, grid, tree, predictive = tradeoff.curves
    assert grid.order.value == pytest.approx(1.0)
    assert grid.order.enough
    assert tree.order is None
    assert predictive.order is None


def test_the_page_says_what_to_use_and_so_does_the_overview(pages):
    said = "For 10 spheres at packing 0.00500 at an error of 10⁻⁴ s, use own predictive, 20.4 ms of CPU time"
    lost = "; fcl brute-force, own grid, fcl tree do not reach it."
    for name in ("accuracy.html", "index.html"):
        assert said + lost in text_of(pages[name]).replace("\u00a0", " ")


def test_the_ratio_to_the_next_method_has_its_interval(tmp_path):
    """Of 10 ms frames, brute force costs ten times the grid, repeat by repeat."""
    database = write(
        tmp_path / "x.db",
        [Invented(**{**vars(ACCURACY), "swept": {"algorithm": ["brute-force", "grid"], "dt": STEPS[:3]}})],
    )
    (accuracy,) = Results(database).accuracy
    assert accuracy.tradeoffs[0].decided == 1e-2
    text = dict(render(database))["accuracy.html"]
    assert (
        "use own grid (dt 1/60), 6.12 ms of CPU time: 10× [10, 10] cheaper than fcl brute-force (dt 1/60)"
        in text_of(text).replace("\u00a0", " ")
    )


@pytest.mark.slow
def test_with_fewer_than_five_repeats_no_method_is_the_fastest_at_an_error(tmp_path):
    few = Invented(**{**vars(ACCURACY), "swept": {"algorithm": ["brute-force", "grid"], "dt": STEPS[:3]}, "repeats": 3})
    html = dict(render(write(tmp_path / "x.db", [few])))["accuracy.html"]
    text = text_of(html).replace("\u00a0", " ")
    assert "the CPU time is fcl brute-force (dt 1/60)" in text
    assert "too few repeats to rank (fewer than 5 pairs)." in text
    assert "cheaper than" not in text
    assert " use grid" not in text
    fastest = html[html.index("Fastest at an error") : html.index("Every setting, and the hits it saw")]
    assert 'class="n best"' not in fastest


def test_a_method_that_cannot_reach_an_error_says_how_far_it_came(pages):
    text = text_of(pages["accuracy.html"]).replace("\u00a0", " ")
    assert "least error 125 µs" in text
    assert "30 % of hits wrong" in text


def test_the_reference_is_trusted_as_far_as_it_was_checked(pages):
    assert "right to 1.00 × 10⁻¹⁴ s" in text_of(pages["accuracy.html"]).replace("\u00a0", " ")


def test_figures_say_what_they_show_and_can_be_had_as_files(pages):
    html = pages["accuracy.html"]
    assert "accuracy/scene0-0.svg" in pages
    assert 'href="accuracy/scene0-0.svg"' in html
    assert "grid: an error of 33.3 ms in 1.53 ms to 125 µs in 408 ms" in text_of(html).replace("\u00a0", " ")


def test_errors_of_a_power_of_ten_are_written_in_full_on_the_axis(pages):
    ticks = re.findall(r">([^<>]*)</text>", pages["accuracy/scene0-0.svg"])
    assert "10⁻¹²" in ticks
    assert "0.00" not in ticks


def test_the_page_is_well_formed_and_whole_without_a_network(pages):
    html, outline = pages["accuracy.html"], Outline()
    outline.feed(html)
    assert not outline.open
    assert len(set(outline.ids)) == len(outline.ids)
    assert set(outline.references) <= set(outline.ids)
    for href in re.findall(r'href="([^"#][^"]*)"', html):
        assert href.split("#")[0] in pages


@pytest.mark.slow
def test_in_free_flight_the_page_says_how_long_the_exact_motion_is_followed(tmp_path):
    def fate(parameters, repeat, metrics):
        metrics |= {"divergence_time": 0.1 / parameters["dt"], "position_error": parameters["dt"]}
        metrics |= {"reference_divergence_time": 9.0, "reference_position_error": 2e-12}

    free = Invented(**{**vars(ACCURACY), "swept": {"dt": STEPS}, "fate": fate})
    text = text_of(dict(render(write(tmp_path / "x.db", [free])))["accuracy.html"]).replace("\u00a0", " ")
    assert "How long the exact motion is followed" in text
    assert "the reference shares its hits for 9 s, and its places to 2.00 × 10⁻¹² m." in text.replace("\u202f", " ")
    assert "divergence time" in text.lower()


@pytest.mark.slow
def test_without_a_reference_there_is_no_page(tmp_path):
    database = write(tmp_path / "x.db", [Invented(**{**vars(ACCURACY), "reference": None})])
    pages = dict(render(database))
    assert "accuracy.html" not in pages
    assert "accuracy.html" not in pages["index.html"]


@pytest.mark.slow
def test_runs_that_failed_leave_what_there_is(tmp_path):
    def fate(parameters, repeat, metrics):
        invented(parameters, repeat, metrics)
        return ("timeout", "too long") if parameters["algorithm"] != "grid" else None

    pages = dict(render(write(tmp_path / "x.db", [Invented(**{**vars(ACCURACY), "fate": fate})])))
    assert "Error against run time" in pages["accuracy.html"]
    nothing = Invented(**{**vars(ACCURACY), "fate": lambda *_: ("crashed", "signal 11")})
    assert "accuracy.html" not in dict(render(write(tmp_path / "y.db", [nothing])))


def test_a_method_has_the_style_that_it_has_on_every_other_page(results, tradeoff):
    (page,) = Results(results).pages
    assert {curve.label: curve.style for curve in tradeoff.curves} == {
        series.label: series.style for series in page.arrangement.series
    }
    assert [curve.style for curve in tradeoff.curves] == [style_of(curve.method) for curve in tradeoff.curves]
