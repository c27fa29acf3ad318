"""What the database keeps of a comparison, and when."""

import pytest

from harness.cli.main import main
from harness.store import tables
from tests.compare.conftest import two_spheres


@pytest.mark.slow
def test_verdicts_are_kept_where_db_says_and_the_newest_count(defective, tmp_path, capsys):
    path = two_spheres(tmp_path / "two.yaml", 0)
    database = tmp_path / "kept.db"
    names = f"fcl,{defective('blind')}"
    for _ in range(2):
        assert main(["compare", path, "--backends", names, "--db", str(database)]) == 1
    (record,) = tables.comparisons(database)
    assert (record.experiment, record.backends) == ("two", ("fcl", "blind"))
    (shown,) = record.document["shown"]
    assert shown["minimised"]["gap"] < 0
    assert shown["text"].startswith("#")
    assert len(shown["section"]) == 2


@pytest.mark.slow
def test_a_sweep_compares_what_asks_for_it_once(tmp_path, capsys):
    path = tmp_path / "asked.yaml"
    path.write_text(
        "title: Asked\nscene: {shape: sphere, count: 5, box: [4, 4, 4]}\n"
        "motion: {duration: 0.1, dt: 1/30, response: none}\n"
        "zip: [{backend: [fcl, pybullet], algorithm: [grid, native]}]\nmeasure: {repeats: 1, compare: on}\n"
    )
    assert main(["sweep", str(path), "--db", "results.db"]) == 0
    assert "asked: fcl/grid and pybullet: " in capsys.readouterr().out
    (record,) = tables.comparisons("results.db")
    (pair,) = record.document["pairs"]
    assert pair["verdicts"] == pair["agree"] + pair["undecided"] > 4 * 10
    assert main(["sweep", str(path), "--db", "results.db"]) == 0
    assert "asked: fcl and pybullet" not in capsys.readouterr().out
    assert tables.comparisons("results.db") == [record]
