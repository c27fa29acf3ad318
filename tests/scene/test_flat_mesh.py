"""A mesh in one plane is a surface as any other: it has shape mesh, and is refused where a hull is needed."""

from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.errors import InputError
from harness.experiment.load import load_text
from harness.runner.execute import execute
from harness.runner.preparation import prepare
from harness.scene.mesh_child import open_meshes
from harness.scene.mesh_file import make_mesh, read_mesh
from harness.scene.scene_files import SceneFiles

QUAD = "v -5 -5 0\nv 5 -5 0\nv -5 5 0\nv 5 5 0\nf 1 2 3\nf 2 4 3\n"
SIDE = np.sqrt(0.5)  # of a square whose bounding sphere has diameter 1
# Squares face to face along z, in the planes z = -0.5 and 0.5, that approach at 2 m/s; and two that pass side by side.
EXPERIMENT = """
title: Flat
scene:
  mesh: quad.obj
  shape: mesh
  box: [6, 6, 6]
  bodies:
  - {{position: [0, 0, -0.5], velocity: [0, 0, 1], orientation: {turn}}}
  - {{position: [{offset}, 0, 0.5], velocity: [0, 0, -1]}}
motion: {{duration: 0.9, dt: 0.04, response: none}}
engine: {{backend: {backend}, algorithm: {algorithm}}}
measure: {{repeats: 1}}
"""
UPRIGHT = "[0.7071067811865476, 0, 0.7071067811865476, 0]"


@pytest.fixture
def quad(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("quad.obj").write_text(QUAD)
    return Path("quad.obj")


def hits(quad, algorithm, turn, offset, backend="fcl"):
    text = EXPERIMENT.format(turn=turn, offset=offset, algorithm=algorithm, backend=backend)
    experiment = load_text(text, quad.absolute().parent / "flat.yaml")
    return execute(experiment.points[0], SceneFiles((read_mesh(quad),)), traced=True).trace


@pytest.mark.parametrize("turn", [0, 0.3])
def test_a_flat_mesh_is_read_and_said_to_be_flat(quad, turn):
    mesh = read_mesh(quad)
    assert (len(mesh.faces), len(mesh.vertices), len(mesh.hull.vertices)) == (2, 4, 4)
    assert mesh.flat
    assert not mesh.convex
    assert mesh.notes[0].startswith("flat: it encloses nothing")
    assert mesh.diameter == pytest.approx(10 * np.sqrt(2))
    tilted = mesh.vertices @ np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    again = make_mesh("", tilted, mesh.faces)
    assert again.flat
    assert np.linalg.norm(again.vertices, axis=1).max() == pytest.approx(0.5, rel=1e-14)
    there = open_meshes([quad])[quad]
    assert there.flat
    assert np.array_equal(there.hull.faces, mesh.hull.faces)


def test_a_flat_mesh_with_two_sides_is_closed_and_not_its_own_hull():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = make_mesh("", corners, np.array([[0, 1, 2], [0, 2, 1]]))
    assert mesh.watertight
    assert mesh.flat
    assert not mesh.convex
    with pytest.raises(InputError, match="no area"):
        make_mesh("", corners * [1, 0, 0], np.array([[0, 1, 2]]))


@pytest.mark.parametrize("algorithm", ["brute-force", "grid", "tree", "sap", "predictive"])
def test_every_method_finds_the_touch_where_the_closed_form_has_it(quad, algorithm):
    # one square stands on its edge: its edge reaches SIDE / 2 up, and meets the other when 1 - 2 t = SIDE / 2
    trace = hits(quad, algorithm, UPRIGHT, 0)
    assert len(trace.times) == 1
    first = (1 - SIDE / 2) / 2
    assert first - 1e-5 <= trace.times[0] <= first + (1e-9 if algorithm == "predictive" else 0.04)
    # beside each other by more than their sides they pass
    assert len(hits(quad, algorithm, UPRIGHT, 1.01 * SIDE).times) == 0


def test_a_hull_of_it_is_refused_where_the_mesh_is_named(quad, capsys):
    text = EXPERIMENT.format(turn=UPRIGHT, offset=0, algorithm="grid", backend="fcl")
    Path("flat.yaml").write_text(text.replace("shape: mesh", "shape: hull"))
    with pytest.raises(InputError, match=r"flat.yaml:4:9: quad.obj: the mesh is flat, so that no hull encloses it"):
        prepare(["flat.yaml"], {})
    assert main(["plan", "flat.yaml"]) == 2
    assert main(["plan", "flat.yaml", "--set", "shape=mesh"]) == 0


def test_a_library_that_replaces_meshes_by_hulls_says_so(quad):
    pytest.importorskip("pybullet", reason="pip install 'harness[pybullet]'")
    with pytest.raises(InputError, match="a flat mesh has none"):
        hits(quad, "native", UPRIGHT, 0, backend="pybullet")


def test_inspect_gives_its_area_and_no_volume(quad, capsys):
    assert main(["mesh", "inspect", "quad.obj"]) == 0
    said = capsys.readouterr().out
    assert "flat                  yes" in said
    assert "area                  100" in said
    assert "volume                –" in said
