"""An atlas is the same however many processes ask."""

from pathlib import Path

import pytest

from harness.cli.surveying import surveyed
from harness.compare.budget import Budget
from harness.runner.preparation import prepare

ATLAS = """
title: An atlas
scene: {mesh: cube.ply, shape: hull, box: [6, 6, 6], bodies: [{position: [-1, 0, 0]}, {position: [1, 0, 0]}]}
motion: {duration: 0, response: none}
sweep: {shape: [sphere, hull]}
measure: {repeats: 1, families: [deep, grazing], family_poses: 24, family_queries: [collision, distance]}
"""


@pytest.mark.slow
def test_an_atlas_by_two_processes_is_that_by_one(tmp_path: Path, defective):
    path = tmp_path / "atlas.yaml"
    path.write_text(ATLAS)
    experiments, meshes = prepare([path], {})
    names = ["fcl", "fcl/grid", defective("blind")]
    said: list[str] = []
    alone = surveyed(experiments[0], meshes, names, Budget(every=2))
    shared = surveyed(experiments[0], meshes, names, Budget(every=2), said.append, workers=2)
    assert said[0] == "collision, deep, sphere: 24 poses"
    assert len(said) == 8

    def told(found):
        return [cell | {"seconds": 0.0} for cell in found.cells()]

    assert told(shared) == told(alone)
    assert sum(cell["wrong"] for cell in told(alone) if cell["engine"] == "blind") > 0
    assert [row.text for row in shared.rows] == [row.text for row in alone.rows] != []
    assert [row.meshes for row in shared.rows] == [row.meshes for row in alone.rows]
    assert shared.scripts == alone.scripts
    assert shared.case_of == alone.case_of
    assert ("cube.ply",) in [row.meshes for row in shared.rows]
