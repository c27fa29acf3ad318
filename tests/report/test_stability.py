"""The matrix of stability: every word follows from stored runs and verdicts, and stands with its number."""

import re
from html import unescape

import pytest

from harness.store.records import VerdictRow

METHODS = {"zip": [{"algorithm": "grid"}, {"algorithm": "predictive"}]}


def judged(metric, verdicts, limit, where=None):
    """A row `at_most: limit` with a group a method: {algorithm: (verdict, value)}."""
    groups = [
        {"parameters": {"algorithm": algorithm}, "verdict": verdict, "statement": "x", "value": value}
        for algorithm, (verdict, value) in verdicts.items()
    ]
    worst = "fails" if "fails" in [verdict for verdict, _ in verdicts.values()] else "holds"
    return VerdictRow({"metric": metric, "at_most": limit, "where": where or {}}, worst, "x", {"groups": groups})


def text_of(html):
    return unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", re.sub(r"<style.*?</style>", "", html, flags=re.S))))


def rows_of(pages):
    table = re.search(r'<table class="matrix".*?</table>', pages["stability.html"], re.S)[0]
    return [text_of(row).strip() for row in re.findall(r"<tr>.*?</tr>", table, re.S)[1:]]


@pytest.fixture
def case(report_of):
    def made(**fields):
        fields = {"name": "stability/x", "title": "Far away", "swept": METHODS, "base": {"shape": "sphere"}} | fields
        return report_of(repeats=1, **fields)

    return made


DRIFT = judged("energy_drift", {"grid": ("holds", 2e-16), "predictive": ("holds", 3e-13)}, 1e-12)


def test_a_false_claim_degrades_and_what_is_held_survives_each_with_its_number(case):
    lost = judged("missed_hits", {"grid": ("fails", 0.4), "predictive": ("holds", 0.0)}, 0.0)
    pages = case(expectations=[DRIFT], claims=[lost])
    (row,) = rows_of(pages)
    assert row == "Far away ≈ degrades missed hits 0.400, not ≤ 0 ✓ survives energy drift 3.00 × 10⁻¹³ ≤ 10⁻¹²"
    said = text_of(pages["stability.html"])
    assert "own grid survives 0 of 1 case, degrades in 1 (Far away)" in said
    assert "own predictive survives 1 of 1 case." in said
    assert 'href="pages/stability/x/index.html"' in pages["stability.html"]
    overview = text_of(pages["index.html"])
    assert "own predictive survives 1 of 1 case." in overview
    assert 'href="stability.html"' in pages["pages/stability/x/index.html"].replace("../", "")


def test_a_broken_expectation_is_a_failure(case):
    broken = judged("energy_drift", {"grid": ("fails", 0.5), "predictive": ("holds", 0.0)}, 1e-12)
    (row,) = rows_of(case(expectations=[broken]))
    assert row.startswith("Far away ✗ fails energy drift 0.500, not ≤ 10⁻¹² ✓ survives")


def test_a_hang_is_a_failure_with_its_reason(case):
    def fate(parameters, *_):
        return ("timeout", "did not end within 30 s") if parameters["algorithm"] == "predictive" else None

    (row,) = rows_of(case(fate=fate, expectations=[DRIFT]))
    assert row.endswith("✗ fails timeout: did not end within 30 s")


def test_a_refusal_is_told_with_its_reason_and_is_no_failed_run_where_it_is_expected(case):
    def fate(*_):
        return "rejected", "equal spheres fill at most 0.740"

    expected = judged("rejected", {"grid": ("holds", 1.0), "predictive": ("holds", 1.0)}, 1.0)
    pages = case(fate=fate, expectations=[expected])
    (row,) = rows_of(pages)
    assert row.count("⊘ refuses equal spheres fill at most 0.740") == 2
    assert "none failed" in text_of(pages["index.html"])
    assert "Broken or failed" not in text_of(pages["index.html"])


def test_a_refusal_that_nobody_expects_is_a_failed_run(case):
    pages = case(fate=lambda *_: ("rejected", "too dense"), expectations=[DRIFT])
    assert "2 failed" in text_of(pages["index.html"])


def test_each_shape_is_a_case_and_what_was_not_run_is_no_verdict(case):
    swept = {"zip": [{"algorithm": "grid", "shape": "hull"}, {"algorithm": "grid", "shape": "mesh"},
                     {"algorithm": "predictive", "shape": "hull"}]}  # fmt: skip
    rows = rows_of(case(swept=swept, expectations=[DRIFT]))
    assert [row.split(" ✓")[0] for row in rows] == ["Far away: hull", "Far away: mesh"]
    assert rows[1].endswith("not run")


def test_without_cases_there_is_no_matrix(report_of):
    pages = report_of()
    assert "stability.html" not in pages
    assert "Stability" not in text_of(pages["index.html"])


def test_a_pipeline_whose_questions_are_answered_by_different_hands_has_a_column_for_each(case):
    """FCL decides on collisions of brute force; near pairs are found by kernels of this program."""
    swept = {"zip": [{"algorithm": "brute-force", "query": query} for query in ("collision", "distance")]}
    said = text_of(case(swept=swept, base={"shape": "hull", "within": 0.1})["stability.html"])
    assert "fcl brute-force survives 1 of 1 case." in said
    assert "own brute-force survives 1 of 1 case." in said
    assert "1 cases, 2 methods" in said
