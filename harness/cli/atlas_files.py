"""An atlas as files: a row of a table for every engine and family, and every accusation with the proof of it."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from harness.cli.surveying import Surveyed, cell_row
from harness.compare.atlas import Cell
from harness.compare.outcome import Case
from harness.whole_file import write_whole

CELLS, ACCUSATIONS = "cells.csv", "accusations.json"

_COLUMNS = (*(field.name for field in fields(Cell)), "per_million", "low", "high")


def save_atlas(found: Surveyed, files: Mapping[int, Path], folder: Path) -> None:
    """Write `cells.csv` and `accusations.json`.

    An accusation has both bodies as the engine was judged on them, so that the proof can be checked without this
    program: vertices in their own frame, m, triangles of a mesh, position, m, quaternion, all doubles, and the
    certificate.

    Parameters
    ----------
    found : Surveyed
    files : by place of a case, the experiment that shows it, beside which a Python file may do so
    folder : of both files; made if it is not there
    """
    folder.mkdir(parents=True, exist_ok=True)
    stream = io.StringIO()
    table = csv.DictWriter(stream, _COLUMNS, lineterminator="\n")
    table.writeheader()
    table.writerows({name: _short(value) for name, value in cell_row(cell).items()} for cell in found.atlas.cells)
    write_whole(folder / CELLS, stream.getvalue())
    rows = [json.dumps(row, allow_nan=False) for row in _accusations(found, files)]
    write_whole(folder / ACCUSATIONS, "[\n" + ",\n".join(rows) + "\n]\n" if rows else "[]\n")


def _accusations(found: Surveyed, files: Mapping[int, Path]) -> Iterator[dict[str, Any]]:
    """Of whether bodies touch; what no scene of its own shows is no accusation that anybody could check."""
    for cell, case in found.case_of.items():
        seen, small = found.atlas.cells[cell], found.rows[case].small
        if seen.query == "collision" and small is not None:
            named = {"engine": seen.engine, "family": seen.family, "shape": seen.shape, "mesh": seen.mesh}
            yield named | _proven(small) | {"file": _shown_by(files.get(case))}


def _shown_by(experiment: Path | None) -> str:
    if experiment is None:
        return ""
    script = experiment.with_suffix(".py")
    return (script if script.exists() else experiment).name


def _proven(case: Case) -> dict[str, Any]:
    scene, pose, truth = case.scene, case.pose, case.judgement
    return {
        "says": not truth.touching,
        "touching": truth.touching,
        "gap": truth.gap,
        "certificate": truth.certificate,
        "bodies": [
            {
                "size": float(scene.bodies.sizes[body]),
                "position": pose.positions[body].tolist(),
                "quaternion": pose.quaternions[body].tolist(),
            }
            | _solid(case, body)
            for body in case.bodies
        ],
    }


def _solid(case: Case, body: int) -> dict[str, Any]:
    if case.scene.shape == "sphere":
        return {"vertices": [], "faces": []}
    solid = case.scene.solid_of_body(body)
    return {
        "vertices": solid.vertices.tolist(),
        "faces": solid.faces.tolist() if case.scene.shape == "mesh" else [],
    }


def _short(value: object) -> object:
    return f"{value:.6g}" if isinstance(value, float) else value
