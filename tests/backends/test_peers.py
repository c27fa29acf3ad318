"""Backends that are extras: right where they are installed, and named with the command that brings them where not."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.backends import registry
from harness.backends.protocol import own_hulls, precision, units
from harness.cli.main import main
from harness.errors import InputError
from harness.scene.box import Box
from harness.scene.scene import Scene
from tests.conftest import cube_mesh, make_bodies, random_scene

EXAMPLE = Path(__file__).parent / "example_backend"
PEERS = {
    "cgal": ("igl", "Cgal"), "coal": ("coal", "Coal"), "drake": ("pydrake", "Drake"), "ipctk": ("ipctk", "Ipctk"),
    "mujoco": ("mujoco", "MuJoCo"), "mujoco_warp": ("mujoco_warp", "MuJoCoWarp"), "parry3d": ("py_parry3d", "Parry3d"),
    "rapier3d": ("rapier3d", "Rapier3d"), "trimesh": ("trimesh", "Trimesh"),
}  # fmt: skip


@pytest.fixture(params=PEERS)
def peer(request):
    library, name = PEERS[request.param]
    pytest.importorskip(library)
    return getattr(__import__(f"harness.backends.{request.param}", fromlist=["x"]), name)


def touching(backend, scene):
    backend.load(scene)
    return backend.pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_a_peer_finds_the_pairs_that_fcl_finds(peer, shape):
    if shape not in peer.shapes:
        pytest.skip("it has no such shape")
    for seed, side in ((0, 4.0), (1, 10.0)):
        scene = random_scene(shape, 60, side, seed)
        assert touching(peer(), scene) == touching(registry.create("fcl"), scene)


@pytest.mark.parametrize("shape", ["sphere", "hull"])
def test_a_peer_has_room_for_a_crowd_in_which_all_bodies_touch(peer, shape):
    if shape not in peer.shapes:
        pytest.skip("it has no such shape")
    assert len(touching(peer(), random_scene(shape, 60, 1.2, 0))) == 60 * 59 // 2


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e5])
def test_a_peer_keeps_to_the_band_it_states(peer, shape, size):
    if shape not in peer.shapes:
        pytest.skip("it has no such shape")
    if peer.name == "mujoco_warp" and shape != "sphere":
        pytest.skip("it misses hulls that overlap along a direction of theirs, however deep")
    width = 1.0 if shape == "sphere" else 1 / np.sqrt(3)
    band = max(2e-15, peer().tolerance(shape)) * 2
    for gap, hits in ((band, []), (-band, [[0, 1]])):
        positions = np.array([[0, 0, 0], [width + gap, 0, 0]]) * size
        bodies = make_bodies(positions, sizes=[size, size])
        assert touching(peer(), Scene(shape, (cube_mesh(),), bodies, Box(np.full(3, 9 * size)))) == hits


def test_a_peer_says_what_it_is(peer):
    assert units(peer())
    assert precision(peer())
    scene, backend = random_scene(peer.shapes[-1], 2, 5.0), peer()
    backend.load(scene)
    with pytest.raises(ValueError, match="not finite"):
        backend.pairs(np.full((2, 3), np.nan), scene.bodies.quaternions)


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_parry_says_which_pairs_fcl_finds_near(shape):
    pytest.importorskip("py_parry3d")
    scene, within = random_scene(shape, 40, 4.5, seed=3), 0.2
    poses = scene.bodies.positions, scene.bodies.quaternions
    parry, fcl = registry.create("parry3d"), registry.create("fcl")
    for backend in (parry, fcl):
        backend.load(scene)
    near = parry.near(*poses, within).tolist()
    assert near == fcl.distances(*poses, within).pairs.tolist()
    assert len(near) > len(parry.pairs(*poses)) > 5


def test_mujoco_hands_out_the_hulls_that_it_holds():
    pytest.importorskip("mujoco")
    from harness.backends.mujoco import MuJoCo

    scene = random_scene("hull", 3, 5.0)
    backend = MuJoCo()
    backend.load(scene)
    (hull,) = own_hulls(backend).values()
    given = scene.mesh.hull.vertices
    nearest = np.linalg.norm(hull.vertices[:, None] - given, axis=2).min(axis=1)
    assert len(hull.vertices) == len(given)
    assert 0 < nearest.max() < 1e-7


@pytest.fixture
def lacking(tmp_path, monkeypatch):
    """Declares a backend whose library is missing, as an extra of its package."""
    folder = tmp_path / "lacking"
    metadata = folder / "odd_engine-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: odd-engine\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[harness.backends]\nodd = odd_backend:Odd [fast]\n")
    (folder / "odd_backend.py").write_text("import there_is_no_such_library\n")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    monkeypatch.chdir(tmp_path)
    return "odd"


def test_a_missing_extra_is_named_with_the_command_that_brings_it(lacking, capsys):
    with pytest.raises(InputError, match=r"pip install 'odd-engine\[fast\]'"):
        registry.create(lacking)
    assert main(["list", "--json"]) == 0
    (row,) = [row for row in json.loads(capsys.readouterr().out)["backends"] if row["name"] == lacking]
    assert row["install"] == "pip install 'odd-engine[fast]'"
    assert row["install"] in row["missing"]


def test_an_experiment_with_nothing_but_a_missing_extra_is_an_error_that_says_so(lacking, tmp_path, capsys):
    path = tmp_path / "one.yaml"
    path.write_text(
        "title: One\nscene: {shape: sphere, count: 2, box: [9, 9, 9]}\nengine: {backend: odd, algorithm: native}\n"
    )
    assert main(["validate", str(path)]) == 2
    said = capsys.readouterr()
    assert "one.yaml:3:19: " in said.out + said.err
    assert "pip install 'odd-engine[fast]'" in said.out + said.err


def test_of_several_backends_those_not_installed_are_passed_over_with_the_hint(lacking, tmp_path, capsys):
    path = tmp_path / "two.yaml"
    path.write_text(
        "title: Two\nscene: {shape: sphere, count: 2, box: [9, 9, 9]}\n"
        "zip: [{backend: [fcl, odd], algorithm: [grid, native]}]\nmeasure: {repeats: 3}\n"
    )
    assert main(["sweep", str(path), "--dry-run"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "points passed over: backend \"odd\" cannot be used: not installed; pip install 'odd-engine[fast]'" in said
    assert "3 runs to do" in said
    assert main(["compare", str(path), "--backends", "fcl,odd"]) == 2
    assert "pip install 'odd-engine[fast]'" in capsys.readouterr().err


def test_trimesh_has_no_spheres_and_says_what_to_exclude(tmp_path, capsys):
    path = tmp_path / "one.yaml"
    path.write_text(
        "title: One\nscene: {shape: sphere, count: 2, box: [9, 9, 9]}\nengine: {backend: trimesh, algorithm: native}\n"
    )
    assert main(["validate", str(path)]) == 2
    said = capsys.readouterr()
    assert "backend trimesh has no shape sphere, only hull and mesh" in said.out + said.err


@pytest.mark.slow
def test_a_backend_of_another_package_is_installed_and_used(tmp_path):
    site, results = tmp_path / "site", tmp_path / "results.db"
    install(EXAMPLE, site)
    experiment = tmp_path / "spheres.yaml"
    experiment.write_text(
        "title: Spheres\nscene: {shape: sphere, count: 30, box: [5, 5, 5]}\nmotion: {duration: 0.5, response: none}\n"
        "zip: [{backend: [fcl, bounding-boxes], algorithm: [grid, native]}]\nmeasure: {repeats: 1}\n"
    )
    listing = json.loads(harness(site, tmp_path, "list", "--json"))
    (row,) = [row for row in listing["backends"] if row["name"] == "bounding-boxes"]
    assert row["missing"] is None
    assert (row["shapes"], row["precision"]) == (["sphere"], "double")
    harness(site, tmp_path, "sweep", str(experiment), "--db", str(results), "--quiet")
    exported = json.loads(harness(site, tmp_path, "export", "--db", str(results), "--format", "json"))
    contacts = [run["metrics"]["pair_contacts"] for run in exported["runs"]]
    assert contacts[0] == contacts[1] > 0


def install(package, site):
    """As pip would without a network: the modules, and beside them the metadata of the pyproject file."""
    try:
        import tomllib
    except ModuleNotFoundError:
        import tomli as tomllib
    project = tomllib.loads((package / "pyproject.toml").read_text())["project"]
    metadata = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    points = project["entry-points"]["harness.backends"].items()
    (metadata / "entry_points.txt").write_text(
        "[harness.backends]\n" + "".join(f"{name} = {where}\n" for name, where in points)
    )
    for module in package.glob("*.py"):
        (site / module.name).write_text(module.read_text())


def harness(site, folder, *arguments):
    path = os.pathsep.join([str(site), str(Path(__file__).parents[2])])
    ran = subprocess.run(
        [sys.executable, "-m", "harness", *arguments],
        cwd=folder, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return ran.stdout
