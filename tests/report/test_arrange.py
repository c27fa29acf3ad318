"""Points arranged into series."""

from harness.report.arrange import arrange
from harness.report.styles import style_of
from harness.store.tables import experiments, runs
from harness.vocabulary import MethodName


def arranged(database, name):
    record = next(record for record in experiments(database) if record.name == name)
    return arrange(record, runs(database, [name]))


def test_x_is_what_the_experiment_asks_for_and_a_leaf_it_determines_is_no_series(database):
    found = arranged(database, "homework/complexity")
    assert (found.x, found.x_values, len(found.series)) == ("faces", (1753, 9868, 17001), 1)


def test_the_first_swept_number_is_x_by_default(database):
    assert arranged(database, "few").x == "count"


def test_without_a_number_the_scene_goes_along_x_and_the_method_makes_series(database):
    found = arranged(database, "backends")
    assert (found.x, [series.label for series in found.series]) == ("mesh", ["fcl", "pybullet"])
    assert not found.numeric


def test_too_many_series_are_split_into_panels_by_the_scene(database):
    found = arranged(database, "homework/algorithms")
    assert found.panels == ("box_ratio 0.01", "box_ratio 0.04", "box_ratio 0.25")
    assert {series.label: series.style for series in found.series} == {
        name.label: style_of(name)
        for name in (MethodName("fcl", word, "sphere") for word in ("brute-force", "grid", "predictive"))
    }


def test_every_point_is_in_one_series(database):
    for name in ("homework/algorithms", "backends", "single", "broken"):
        found = arranged(database, name)
        record = next(record for record in experiments(database) if record.name == name)
        assert sorted(point.row.key for point in found.points) == sorted(point.key for point in record.points)


def test_a_failed_run_counts_in_no_median(database):
    found = arranged(database, "homework/algorithms")
    point = next(series for series in found.series if series.label == "fcl brute-force").at(1000)
    assert len(point.runs) == 5
    assert point.summary("pair_seconds") is None
