"""What is kept of an experiment file is told only as long as nothing that it was found out from has changed."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from harness import kept_files
from harness.cli.main import main
from harness.experiment import kept_facts
from harness.scene.mesh_cache import KIND
from harness.vocabulary import OWN_BACKEND

CUBE = Path(__file__).parents[2] / "meshes" / "cube.ply"
TEXT = """title: Two cubes
scene: {mesh: mine.ply, shape: hull, count: 2, box: [9, 9, 9]}
motion: {duration: 1}
engine: {algorithm: grid}
sweep: {count: [2, 3]}
measure: {repeats: 2}
"""
COMMANDS = (["validate", "experiments"], ["list", "--json"], ["plan", "experiments/a.yaml"])


def put(path, content):
    """A file that has been there for a while: one that changes as a command runs is no ground to keep anything."""
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(content)
    os.utime(path, (1e9, 1e9))


@pytest.fixture(scope="module")
def kept_meshes(tmp_path_factory):
    """Where meshes are kept for all tests: a process that reads one takes longer than a test."""
    return tmp_path_factory.mktemp("meshes")


@pytest.fixture
def folder(tmp_path, monkeypatch, kept_meshes):
    """A folder of experiments, of which nothing is kept yet."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder_of = kept_files.folder
    monkeypatch.setattr(kept_files, "folder", lambda kind: kept_meshes if kind == KIND else folder_of(kind))
    monkeypatch.chdir(tmp_path)
    put(tmp_path / "experiments" / "a.yaml", TEXT.encode())
    put(tmp_path / "meshes" / "mine.ply", CUBE.read_bytes())
    return tmp_path


@pytest.fixture
def said(capsys):
    """What a command prints, and its exit code."""

    def ask(*command):
        code = main(command)
        return code, capsys.readouterr()

    return ask


@pytest.fixture
def unread(monkeypatch):
    """Loading any file is an error from now on."""

    def forbid():
        def load(path, *_):
            raise AssertionError(f"{path} is loaded again")

        monkeypatch.setattr("harness.experiment.load.load", load)
        monkeypatch.setattr("harness.runner.preparation.load", load)
        monkeypatch.setattr("harness.truth.declaration.load_truth", load)

    return forbid


def facts_in(folder):
    return list((folder / "cache" / "harness" / "facts").glob("*.json"))


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_file_that_has_not_changed_is_not_read_again_and_the_same_is_said(folder, said, unread, command):
    import harness.truth.declaration  # noqa: F401  is imported where it is needed

    put(
        folder / "experiments" / "b.yaml",
        b"title: t\nfamilies: {random: {count: 3, meshes: [mine.ply]}}\n",
    )
    first = said(*command)
    assert first[0] == 0
    unread()
    assert said(*command) == first


@pytest.mark.parametrize("json_form", [[], ["--json"]])
def test_a_kept_plan_is_printed_as_the_first_was(folder, said, unread, json_form):
    others = [said("plan", "experiments/a.yaml", *json_form, "--set", f"count={count}") for count in (2, 4)]
    first = said("plan", "experiments/a.yaml", *json_form)
    assert first not in others
    unread()
    assert said("plan", "experiments/a.yaml", *json_form) == first
    assert said("plan", "experiments/a.yaml", *json_form, "--set", "count=4") == others[1]


def test_a_changed_file_is_read_again_and_only_that(folder, said, monkeypatch):
    put(folder / "experiments" / "b.yaml", TEXT.encode())
    assert said("validate", "experiments")[1].out.splitlines() == ["a: 2 points, 4 runs", "b: 2 points, 4 runs"]
    from harness.experiment.load import load

    loaded = []
    monkeypatch.setattr("harness.runner.preparation.load", lambda path, *more: loaded.append(path) or load(path, *more))
    put(folder / "experiments" / "a.yaml", TEXT.replace("repeats: 2", "repeats: 3").encode())
    assert said("validate", "experiments")[1].out.splitlines() == ["a: 2 points, 6 runs", "b: 2 points, 4 runs"]
    assert loaded == [Path("experiments/a.yaml")]


def test_a_mesh_that_was_spoilt_or_taken_away_is_noticed(folder, said):
    assert said("validate", "experiments")[0] == 0
    put(folder / "meshes" / "mine.ply", b"no mesh")
    code, printed = said("validate", "experiments")
    assert code == 2
    assert printed.err.startswith("experiments/a.yaml:2:15: ")
    put(folder / "meshes" / "mine.ply", CUBE.read_bytes())
    assert said("validate", "experiments")[0] == 0
    (folder / "meshes" / "mine.ply").unlink()
    for command in COMMANDS[::2]:
        code, printed = said(*command)
        assert code == 2
        assert 'there is no mesh "mine.ply"' in printed.err
    assert json.loads(said(*COMMANDS[1])[1].out)["experiments"][0]["problems"] == 1


@pytest.mark.slow
def test_a_mesh_that_stands_nearer_is_noticed(folder, said):
    assert said("validate", "experiments")[0] == 0
    put(folder / "experiments" / "mine.ply", b"no mesh")
    assert said("validate", "experiments")[0] == 2


@pytest.mark.slow
def test_poses_that_have_changed_are_noticed(folder, said):
    def record(bodies):
        path = folder / "experiments" / "bin.npz"
        turned = np.tile([1.0, 0, 0, 0], (2, bodies, 1))
        np.savez(path, time=[0.0, 1.0], positions=np.zeros((2, bodies, 3)), quaternions=turned)
        os.utime(path, (1e9, 1e9))

    text = "title: t\nscene: {shape: sphere, count: 2}\nmotion: {poses: bin.npz}\nengine: {algorithm: grid}\n"
    put(folder / "experiments" / "a.yaml", text.encode())
    record(2)
    assert said("validate", "experiments")[0] == 0
    record(3)
    code, printed = said("validate", "experiments")
    assert code == 2
    assert "bin.npz has poses of 3 bodies, not 2" in printed.err


def test_another_program_or_another_installation_knows_nothing(folder, said, monkeypatch):
    said("validate", "experiments")
    path = Path("experiments/a.yaml")
    assert kept_facts.kept_facts("validate", path, {}) == {"valid": "2 points, 4 runs"}
    monkeypatch.setattr(kept_facts, "installed", lambda: "something else")
    assert kept_facts.kept_facts("validate", path, {}) is None


def test_of_what_is_wrong_nothing_is_kept(folder, said):
    put(folder / "experiments" / "a.yaml", TEXT.replace("count: 2", "cuont: 2").encode())
    wrong = said("validate", "experiments")
    assert wrong[0] == 2
    assert said("validate", "experiments") == wrong
    assert said("plan", "experiments/a.yaml")[0] == 2
    assert facts_in(folder) == []


@pytest.mark.slow
def test_files_of_one_name_are_wrong_however_often_they_are_looked_at(folder, said):
    copies = [folder / "one" / "experiments", folder / "other" / "experiments"]
    for copy in copies:
        shutil.copytree(folder / "experiments", copy)
        assert said("validate", str(copy))[0] == 0
    for _ in range(2):
        code, printed = said("validate", *map(str, copies))
        assert code == 2
        assert "results are kept by name" in printed.err


def test_a_mesh_that_changed_as_the_command_ran_is_no_ground_to_keep_anything(folder, said):
    os.utime(folder / "meshes" / "mine.ply")
    assert said("validate", "experiments")[0] == 0
    assert facts_in(folder) == []


def test_a_kept_file_that_is_garbage_is_none(folder, said):
    first = said("validate", "experiments")
    for garbage in (b"", b"{", b"[]", b"{}", b'{"files": [[]], "facts": 1}', b'{"files": [["mesh"]], "facts": {}}'):
        (file,) = facts_in(folder)
        file.write_bytes(garbage)
        assert said("validate", "experiments") == first


def test_a_backend_from_elsewhere_is_asked_each_time(folder, said, monkeypatch):
    monkeypatch.setattr("harness.backends.registry.ours", lambda name: name != OWN_BACKEND)
    assert said("validate", "experiments")[0] == 0
    assert said("plan", "experiments/a.yaml")[0] == 0
    assert facts_in(folder) == []
