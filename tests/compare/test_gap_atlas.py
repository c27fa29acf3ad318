"""The atlas of gaps: exact distances decide, an engine that is off is found, and one that is right is not accused."""

import json
from fractions import Fraction
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.cli.surveying import cell_row
from harness.compare.atlas import survey
from harness.compare.budget import Budget
from harness.compare.exact_gap import ExactGap
from harness.compare.families import family_poses
from harness.compare.gap_atlas import SURVEYS
from harness.vocabulary import OWN
from tests.compare import liars, recheck
from tests.conftest import cube_mesh

EXPERIMENTS = Path(__file__).parents[2] / "experiments"
FAMILIES = ["random", "grazing", "shared"]
LONG = """
    def distances(self, positions, quaternions, within):
        found = super().distances(positions, quaternions, 2 * within)
        long = found.gaps * 1.01
        return found._replace(pairs=found.pairs[long <= within], gaps=long[long <= within], points=None)
"""


def found(query, shape, engines, families=FAMILIES, count=4):
    made = survey(shape, cube_mesh(), families, count, engines, Budget(), asks=SURVEYS[query])
    json.dumps([cell_row(cell) for cell in made.cells], allow_nan=False)  # as `--json` and the database have them
    return {(cell.engine, cell.family): (cell.verdicts, cell.beyond) for cell in made.cells}


@pytest.mark.parametrize("query", ["distance", pytest.param("tolerance", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "shape", ["hull", *(pytest.param(shape, marks=pytest.mark.slow) for shape in ("sphere", "mesh"))]
)
def test_the_kernels_and_fcl_are_never_off_by_more_than_their_tolerance(query, shape):
    cells = found(query, shape, ["fcl", OWN])
    assert len(cells) == 6
    assert {beyond for _, beyond in cells.values()} == {0}


def test_gaps_that_are_one_percent_too_long_are_found_wherever_bodies_are_apart(tmp_path, monkeypatch):
    monkeypatch.setitem(liars.LIARS, "long-gaps", LONG)
    name = liars.install("long-gaps", tmp_path / "plugins", monkeypatch)
    for query in ("distance", "tolerance"):
        cells = found(query, "hull", [name], ["random", "deep"], 24)
        assert cells[name, "random"][1] > 0
        assert cells[name, "deep"] == (24, 0)  # which all overlap: 0 is 0, however long


def test_a_gap_is_at_most_itself_to_the_last_bit():
    for shape in ("sphere", "hull", "mesh"):
        for pose_set in family_poses("random", shape, (cube_mesh(),), 6):
            for pose in pose_set.poses(pose_set.scene):
                truth = ExactGap(pose_set.scene, pose)
                truth.check()
                if truth.value > 0.0:
                    assert truth.at_most(truth.value * (1 + 1e-15))
                    assert truth.at_most(truth.value * (1 - 1e-15)) is False
                    assert truth.off_by(truth.value) <= 1e-16


def test_of_two_cubes_on_an_axis_the_gap_is_what_is_between_their_faces():
    from dataclasses import replace

    import numpy as np

    (pose_set,) = family_poses("random", "hull", (cube_mesh(),), 1)
    (pose,) = pose_set.poses(pose_set.scene)
    apart = replace(pose, positions=np.array([[0.0, 0, 0], [1.5, 0, 0]]), quaternions=np.eye(4)[[0, 0]])
    side = 2 * float(pose_set.scene.solid_of(1.0).vertices[:, 0].max())
    assert ExactGap(pose_set.scene, apart).at_most(1.5 - side + 1e-16)
    assert not ExactGap(pose_set.scene, apart).at_most(float(Fraction(1.5) - Fraction(side) - Fraction(1, 10**15)))


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hull", "mesh"])
def test_a_saved_atlas_of_gaps_has_accusations_that_plain_fractions_prove(shape, tmp_path, monkeypatch):
    monkeypatch.setitem(liars.LIARS, "long-gaps", LONG)
    name = liars.install("long-gaps", tmp_path / "plugins", monkeypatch)
    source = (EXPERIMENTS / "atlas/gaps.yaml").read_text(encoding="utf-8")
    source = source.replace("mesh: cube.ply", f"mesh: {EXPERIMENTS.parent / 'meshes/cube.ply'}")
    source = source.replace("[random, aligned, grazing, deep, contained, shared, sizes, far, units]", "[random, deep]")
    (tmp_path / "gaps.yaml").write_text(source)
    command = ["compare", str(tmp_path / "gaps.yaml"), "--backends", f"fcl,{name}", "--set", f"shape={shape}"]
    main([*command, "--save", str(tmp_path / "saved"), "--db", str(tmp_path / "r.db")])
    rows = json.loads((tmp_path / "saved/accusations.json").read_text(encoding="utf-8"))
    assert {(row["engine"], row["family"], row["query"]) for row in rows} == {
        (name, "random", "distance"),
        (name, "random", "tolerance"),
    }
    for row in rows:
        assert row["off"] > row["allowed"]
        assert recheck.proven(row)
        if row["query"] == "distance":
            assert not recheck.proven(row | {"told": row["gap"]})
            assert recheck.proven(row | {"told": 0.0})
        else:
            assert not recheck.proven(row | {"told": 0.0})
