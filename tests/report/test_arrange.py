"""Points arranged into series."""

from harness.report.arrange import arrange
from harness.report.drawing import palette
from harness.report.markup import section_html
from harness.report.styles import style_of
from harness.report.table import Column, Table, words
from harness.store.database import Database
from harness.store.records import PointRow
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


def test_boxes_that_grow_with_the_bodies_are_a_panel_each_packing(tmp_path):
    # sides as a file writes them: the packings of a row differ in the sixth digit
    sides = {(50, 0.05): 8.06, (500, 0.05): 17.3647, (50, 0.2): 5.0775, (500, 0.2): 10.939}
    points = [
        PointRow(f"{count} {packing} {backend}", {
            "count": count, "box": [side] * 3, "packing": count * 0.5235987755982988 / side**3, "backend": backend,
            "algorithm": "native", "shape": "hull", "query": "collision",
        })
        for (count, packing), side in sides.items()
        for backend in ("coal", "mujoco")
    ]  # fmt: skip
    text = "title: Peers\nreport: {x: count}\n"
    with Database.open(tmp_path / "results.db") as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {"processor": "one"}, {})
        specification = {"swept": ["count", "box", "backend"], "report": {"x": "count"}}
        database.list_experiment(sweep, "peers", "Peers", None, text, specification, points)
    found = arranged(tmp_path / "results.db", "peers")
    assert found.panels == ("packing 0.05", "packing 0.2")
    assert [(line.label, line.x) for line in found.series] == [("coal", (50, 500)), ("mujoco", (50, 500))] * 2


def test_the_key_beside_a_row_has_the_colour_and_the_marker_of_a_figure():
    columns = (Column("Method", numeric=False),)
    for style in range(2 * len(palette.LIGHT)):
        key = section_html("one", "One", Table("One", "", columns, ((words("one", style),),)))
        place = palette.SERIES.index(palette.colour(style))
        assert f'class="key c{place}"' in key
        assert f"#k{palette.MARKERS.index(palette.marker(style))}" in key
