"""Published numbers: matched to ours, and held against themselves."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.report.arrange import arrange
from harness.report.published import PublishedRow, distinct, published_rows, recovered, repetitions
from harness.report.sentences.contradictions import contradictions
from harness.store.tables import experiments, runs


def rows_of(database, name):
    record = next(record for record in experiments(database) if record.name == name)
    table = runs(database, [name])
    return published_rows(name, record.specification["published"], arrange(record, table))


def row(numbers, **leaves):
    return PublishedRow("x", leaves, numbers, None, "", 0)


def test_the_counts_of_the_row_of_25_bodies_are_those_of_23():
    (found,) = recovered([row({"pair_tests": 102718.0, "box_tests": 56028.0}, count=25)])
    assert found.bodies == pytest.approx(23, abs=1e-3)
    assert found.frames == pytest.approx(406, abs=0.5)
    assert found.whole
    assert not found.bodies_agree


def test_the_homeworks_rows_imply_other_numbers_of_bodies_than_printed(database):
    found = {int(entry.printed): entry.bodies for entry in recovered(rows_of(database, "homework/number-of-objects"))}
    whole = {printed: round(bodies) for printed, bodies in found.items() if abs(bodies - round(bodies)) < 0.005}
    assert whole == {5: 5, 10: 10, 25: 23, 30: 28, 35: 33, 40: 38, 45: 43, 50: 48}
    assert (round(found[15], 2), round(found[20], 2)) == (14.44, 18.05)


def test_the_printed_count_is_the_scenes_where_the_row_prints_none(database):
    found = recovered(rows_of(database, "homework/complexity"))
    assert [(round(entry.bodies), entry.printed) for entry in found] == [(38, 45), (45, 45), (44, 45)]


def test_frames_by_the_printed_rate_are_not_those_counted(database):
    found = {int(entry.printed): entry for entry in recovered(rows_of(database, "homework/number-of-objects"))}
    assert (round(found[5].frames), round(found[5].frames_timed), found[5].frames_agree) == (478, 851, False)
    assert found[15].frames_agree


@given(frames=st.integers(1, 10**6), bodies=st.integers(2, 10**4))
def test_consistent_counts_give_back_bodies_and_frames(frames, bodies):
    counts = {"pair_tests": frames * bodies * (bodies - 1) / 2, "box_tests": 6.0 * frames * bodies}
    (found,) = recovered([row(counts, count=bodies)])
    assert found.bodies == pytest.approx(bodies)
    assert found.frames == pytest.approx(frames)
    assert found.bodies_agree


def test_a_row_that_repeats_another_experiments_row_is_named(database):
    complexity, number = rows_of(database, "homework/complexity"), rows_of(database, "homework/number-of-objects")
    (found,) = repetitions(complexity, number)
    assert (found.first.leaves["faces"], found.second.leaves["count"]) == (1753, 40)
    assert found.differing == ("frames_per_second",)
    said = " ".join(contradictions(complexity, number))
    assert "homework/number-of-objects" in said
    assert "81.5 and 73.2" in said


def test_the_same_scene_printed_twice_is_no_contradiction(database):
    size, number = rows_of(database, "homework/object-size"), rows_of(database, "homework/number-of-objects")
    assert not [found for found in repetitions(size, number) if found.first.leaves["box_ratio"] == 0.01]


def test_every_row_meets_our_point_with_its_leaves(database):
    found = rows_of(database, "homework/number-of-objects")
    assert [entry.point.parameters["count"] for entry in found] == [entry.leaves["count"] for entry in found]
    assert found[0].ours("pair_tests") == 600 * 5 * 4 / 2


def test_a_fraction_as_text_is_its_number(database):
    record = next(record for record in experiments(database) if record.name == "homework/object-size")
    block = {"rows": [{"box_ratio": "1/4", "pair_tests": 7}]}
    (found,) = published_rows("x", block, arrange(record, runs(database, [record.name])))
    assert found.point.parameters["box_ratio"] == 0.25


def test_a_row_without_our_point_is_kept(database):
    record = next(record for record in experiments(database) if record.name == "homework/object-size")
    block = {"rows": [{"box_ratio": 0.5, "pair_tests": 7}]}
    (found,) = published_rows("x", block, arrange(record, runs(database, [record.name])))
    assert found.point is None
    assert distinct([found, found]) == [found]
