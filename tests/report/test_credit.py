"""Who did the work: what a method is called, and which pairs it put to its library."""

import re

TIMES = {"grid": 1.0, "tree": 4.0, "native": 3.0}
METHODS = {"zip": [{"backend": "fcl", "algorithm": "grid"}, {"backend": "fcl", "algorithm": "tree"},
                   {"backend": "pybullet", "algorithm": "native"}]}  # fmt: skip


def findings_of(pages):
    html = pages["pages/x/index.html"]
    return re.sub(r"<[^>]+>", "", html.partition('id="findings"')[2].partition("</ul>")[0]).replace("\u202f", "")


def counted(parameters, repeat, metrics):
    metrics["pair_seconds"] = TIMES[parameters["algorithm"]] * (1 + 1e-3 * repeat)
    if parameters["algorithm"] != "native":
        tests = 279 * parameters["count"]
        metrics |= {"narrow_tests": tests, "fcl_tests": tests if parameters["algorithm"] == "tree" else 0}


def test_methods_are_named_after_who_decides_and_ranked_in_one_scene(report_of):
    said = findings_of(report_of(swept=METHODS, base={"shape": "hull", "count": 10}, fate=counted))
    assert re.search(r"own grid has the lowest object/object test time.*ahead of pybullet.*ahead of fcl tree", said)
    assert "fcl has" not in said


def test_it_is_said_how_many_pairs_the_library_was_asked_about(report_of):
    swept = METHODS | {"count": [10, 40]}
    said = findings_of(report_of(swept=swept, base={"shape": "hull"}, fate=counted))
    assert "own grid put 0 of 2790 to 11160 pairs to fcl; kernels of this program settled the others." in said
    assert "tree put" not in said


def test_what_was_not_counted_is_not_said(report_of):
    said = findings_of(report_of(swept=METHODS, base={"shape": "hull"}))
    assert "kernels of this program settled" not in said


def tied(parameters, repeat, metrics):
    """Two methods of which the second is now as fast as the first, now four times as slow."""
    slow = 4.0 if parameters["algorithm"] == "tree" and repeat > 1 else 1.0
    metrics["pair_seconds"] = (8.0 if parameters["algorithm"] == "native" else slow) * (1 + 1e-3 * repeat)


def test_medians_that_differ_are_not_about_the_same_though_they_cannot_be_told_apart(report_of):
    said = findings_of(report_of(swept=METHODS, base={"shape": "hull", "count": 10}, fate=tied)).replace("\u00a0", " ")
    assert "cannot be told apart in object/object test time, the lowest, with medians from 1.00 s to 4.01 s" in said
    assert "ahead of pybullet" in said


def unwalled(parameters, repeat, metrics):
    metrics["box_seconds"] = 0.0


def test_a_clock_that_stands_still_is_neither_told_nor_drawn(report_of):
    for swept in (METHODS, {}):
        page = report_of(swept=swept, base={"shape": "hull", "count": 10}, fate=unwalled)["pages/x/index.html"]
        told = page.partition('id="results"')[0].replace("\u00a0", " ")
        assert "object/object test time" in told
        assert "object/wall test time" not in told
        assert "box_seconds" not in told


def test_the_time_of_walls_is_no_librarys(report_of):
    said = findings_of(report_of(swept=METHODS, base={"shape": "hull", "count": 10}))
    assert "Walls are tested by kernels of this program, whatever finds the pairs." in said
    none = findings_of(report_of(swept=METHODS, base={"shape": "hull", "count": 10}, fate=unwalled))
    assert "Walls are tested" not in none
