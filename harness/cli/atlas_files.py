"""An atlas as files: a row of a table for every engine and family, and every accusation with the proof of it."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping
from dataclasses import fields
from math import isinf
from pathlib import Path
from typing import Any

from harness.cli.surveying import Surveyed, cell_row
from harness.compare.atlas import AtlasCell, WrongGap
from harness.compare.outcome import Case
from harness.compare.poses import Pose
from harness.scene.scene import Scene
from harness.whole_file import write_whole

CELLS, ACCUSATIONS = "cells.csv", "accusations.json"

_COLUMNS = (*(field.name for field in fields(AtlasCell)), "per_million", "low", "high")


def save_atlas(found: Surveyed, files: Mapping[int, Path], folder: Path) -> None:
    """Write `cells.csv` and `accusations.json`.

    An accusation has both bodies as the engine was judged on them, so that the proof can be checked without this
    program: vertices in their own frame, m, triangles of a mesh, position, m, quaternion, all doubles, and the
    certificate. One about a gap has what was asked and told, by how much that is off, and what the engine's tolerance
    excuses, m; what was not reported is told as nothing.

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
    for cell, wrong in found.atlas.gaps.items():
        seen = found.atlas.cells[cell]
        named = {"engine": seen.engine, "family": seen.family, "shape": seen.shape, "mesh": seen.mesh}
        yield named | {"query": seen.query} | _proven_gap(wrong)


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
        "bodies": [_body(scene, pose, body) for body in case.bodies],
    }


def _proven_gap(wrong: WrongGap) -> dict[str, Any]:
    return {
        "within": wrong.within,
        "told": None if isinf(wrong.told) else wrong.told,
        "gap": wrong.gap,
        "off": wrong.off,
        "allowed": wrong.allowed,
        "certificate": wrong.certificate,
        "bodies": [_body(wrong.scene, wrong.pose, body) for body in (0, 1)],
    }


def _body(scene: Scene, pose: Pose, body: int) -> dict[str, Any]:
    placed = {
        "size": float(scene.bodies.sizes[body]),
        "position": pose.positions[body].tolist(),
        "quaternion": pose.quaternions[body].tolist(),
    }
    if scene.shape == "sphere":
        return placed | {"vertices": [], "faces": []}
    solid = scene.solid_of_body(body)
    faces = solid.faces.tolist() if scene.shape == "mesh" else []
    return placed | {"vertices": solid.vertices.tolist(), "faces": faces}


def _short(value: object) -> object:
    return f"{value:.6g}" if isinstance(value, float) else value
