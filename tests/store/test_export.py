"""`harness export`: every run, once, in the documented form."""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import pytest

from harness.cli import export
from harness.errors import InputError
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow


@pytest.fixture
def filled(path: Path) -> Path:
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep", None, "0.1.0", {}, {})
        point = PointRow("p", {"count": 5, "size": {"uniform": [0.5, 1.5]}, "mesh": None, "packing": 0.25})
        number = database.list_experiment(sweep, "homework/a", "T", None, "", {}, [point])
        metrics = {
            "frames": (600.0, "1"),
            "drift": (math.nan, "1"),
            "ratio": (math.inf, "1"),
            "pair_seconds": (1e-9, "s"),
        }
        database.add_run(sweep, "p", 0, "ok", None, None, metrics, True)
        database.add_run(sweep, "p", 1, "crashed", 'signal 11, "segfault"\nédité', "…", {}, True)
        database.add_verdicts(sweep, number, "claim", [VerdictRow({"metric": "frames"}, "holds", "é", {"groups": []})])
        database.add_verdicts(sweep, number, "expectation", [VerdictRow({"metric": "drift"}, "fails", "no number")])
    return path


def exported(*words: str) -> int:
    parser = argparse.ArgumentParser()
    export.add_arguments(parser)
    return export.run(parser.parse_args(words))


def no_constant(name: str) -> Any:
    raise AssertionError(f"{name} is no JSON")


def test_json_is_one_document_in_the_promised_shape(filled: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert exported("--db", str(filled), "--format", "json") == 0
    document = json.loads(capsys.readouterr().out, parse_constant=no_constant)
    assert document == {
        "runs": [
            {
                "experiment": "homework/a",
                "parameters": {"count": 5, "size": {"uniform": [0.5, 1.5]}, "mesh": None, "packing": 0.25},
                "repeat": 0,
                "status": "ok",
                "reason": None,
                "metrics": {"frames": 600.0, "drift": None, "ratio": None, "pair_seconds": 1e-9},
            },
            {
                "experiment": "homework/a",
                "parameters": {"count": 5, "size": {"uniform": [0.5, 1.5]}, "mesh": None, "packing": 0.25},
                "repeat": 1,
                "status": "crashed",
                "reason": 'signal 11, "segfault"\nédité',
                "metrics": {},
            },
        ],
        "claims": [
            {
                "experiment": "homework/a",
                "criterion": {"metric": "frames"},
                "verdict": "holds",
                "statement": "é",
                "detail": {"groups": []},
            }
        ],
        "expectations": [
            {
                "experiment": "homework/a",
                "criterion": {"metric": "drift"},
                "verdict": "fails",
                "statement": "no number",
                "detail": {},
            }
        ],
    }


def test_csv_is_a_row_a_run(filled: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert exported("--db", str(filled)) == 0
    first, second = csv.DictReader(io.StringIO(capsys.readouterr().out))
    assert first == {
        "experiment": "homework/a",
        "repeat": "0",
        "status": "ok",
        "reason": "",
        "count": "5",
        "size": '{"uniform": [0.5, 1.5]}',
        "mesh": "",
        "packing": "0.25",
        "frames": "600.0",
        "drift": "nan",
        "ratio": "inf",
        "pair_seconds": "1e-09",
    }
    assert second["reason"] == 'signal 11, "segfault"\nédité'
    assert second["frames"] == ""


def test_a_file_gets_what_would_be_printed(filled: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    exported("--db", str(filled))
    printed = capsys.readouterr().out
    exported("--db", str(filled), "--out", str(tmp_path / "runs.csv"))
    assert (tmp_path / "runs.csv").read_bytes().decode() == printed
    assert capsys.readouterr().out == ""


def test_nothing_to_read_and_nowhere_to_write_are_said(filled: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        exported("--db", str(tmp_path / "none.db"))
    (tmp_path / "none").touch()
    with pytest.raises(InputError, match="cannot be written"):
        exported("--db", str(filled), "--out", str(tmp_path / "none" / "runs.csv"))


def test_an_export_of_nothing_measured_is_empty(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Database.open(path).close()
    exported("--db", str(path), "--format", "json")
    assert json.loads(capsys.readouterr().out) == {"runs": [], "claims": [], "expectations": []}
    exported("--db", str(path))
    assert capsys.readouterr().out == "experiment,repeat,status,reason\n"


def test_what_backends_were_found_to_say_of_each_other_is_exported(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with Database.open(path) as database:
        database.add_comparison("harness compare a.yaml", "a", ("fcl", "pybullet"), "k", {"pairs": [{"agree": 7}]})
    exported("--db", str(path), "--format", "json")
    assert json.loads(capsys.readouterr().out)["comparisons"] == [
        {"experiment": "a", "backends": ["fcl", "pybullet"], "found": {"pairs": [{"agree": 7}]}}
    ]
