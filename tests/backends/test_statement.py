"""A plugin can do whatever it likes when it is asked what it is: it costs its own line only."""

import json
import os
import time
import uuid

import pytest

from harness.backends import registry
from harness.backends.registry import BackendError
from harness.backends.statement import Statement, _asked, approximation, missing, statement
from harness.cli.main import main
from tests.conftest import slow_beyond
from tests.runner.hostile_plugins import MARK, install, left_behind

WAYS = {
    "exits": "importing it ended its process with exit code 3",
    "exits without a word": "importing it ended its process with exit code 0",
    "raises SystemExit": "SystemExit:",
    "hangs with signals blocked": "importing it did not end within 4 s",
    "crashes": "importing it ended its process with signal 11 (SIGSEGV)",
    "closes descriptors": "importing it ended its process with exit code 1",
    "is no Python": "SyntaxError: invalid syntax (odd_backend.py, line 3)",
    "points to nothing": "AttributeError: module 'odd_backend' has no attribute 'Nothing'",
    "points to no module": "ModuleNotFoundError: No module named 'there_is_no_such_module'",
    "points to no name": "AttributeError: 'NoneType' object has no attribute 'group'",
}


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Installs a backend that goes wrong in a way, by the name of odd."""

    def put(way):
        install(tmp_path, way)
        monkeypatch.syspath_prepend(str(tmp_path))
        monkeypatch.chdir(tmp_path)

    return put


@pytest.mark.parametrize(
    "way", slow_beyond(sorted(WAYS, key=lambda way: way not in ("exits", "is no Python", "points to nothing")), 3)
)
def test_why_a_plugin_cannot_be_used_is_told_in_one_line(installed, way):
    installed(way)
    said = statement("odd", 4.0)
    assert said.missing.startswith(WAYS[way])
    assert "\n" not in said.missing
    assert missing("odd") is None  # it is no extra: its runs will say it


@pytest.mark.parametrize("way", slow_beyond(["goes elsewhere", "prints without end", "leaves a process"]))
def test_what_a_plugin_does_besides_is_not_noticed(installed, way, capfd):
    installed(way)
    here = os.getcwd()
    said = statement("odd", 100.0)
    assert (said.missing, said.tolerance) == (None, {"sphere": 1e-9, "hull": 1e-9, "mesh": 1e-9})
    assert os.getcwd() == here
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("way", "missing"), [("leaves a process", None), ("leaves a process and exits", WAYS["exits"])]
)
def test_what_a_plugin_left_behind_is_ended(installed, monkeypatch, way, missing):
    installed(way)
    mark = uuid.uuid4().hex
    monkeypatch.setenv(MARK, mark)
    assert statement("odd", 100.0).missing == missing
    assert left_behind(mark, 0.0) == []


def test_it_is_asked_once(installed):
    installed("goes elsewhere")
    first = statement("odd", 50.0)
    began = time.process_time()
    assert statement("odd", 50.0) is first
    assert time.process_time() - began < 0.05


def test_one_of_ours_is_asked_once_for_all_commands_until_something_is_installed(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = tmp_path / "harness" / "statements"
    _asked.cache_clear()
    said = statement("trimesh")
    (file,) = folder.iterdir()
    with monkeypatch.context() as changed:
        changed.setattr("harness.backends.statement._say", lambda _: Statement("not there"))
        _asked.cache_clear()
        assert statement("trimesh") == said
        (tmp_path / "trimesh.py").write_text("")
        changed.syspath_prepend(str(tmp_path))
        assert statement("trimesh").missing == "not there"
        assert list(folder.iterdir()) == [file]  # why one is missing is found out each time
    file.write_text("{")
    _asked.cache_clear()
    assert statement("trimesh") == said


def test_that_one_of_ours_lacks_a_package_is_known_until_there_is_one(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def create(name):
        why = BackendError(name, "not installed; pip install drake")
        raise why from ModuleNotFoundError("No module named no_library", name="there_is_no_such_library.a")

    with monkeypatch.context() as changed:
        changed.setattr(registry, "create", create)
        _asked.cache_clear()
        said = statement("drake")
        assert (said.installed, said.missing) == (False, "not installed; pip install drake")
    monkeypatch.setattr("harness.backends.statement._say", lambda _: Statement("asked again"))
    _asked.cache_clear()
    assert statement("drake") == said
    monkeypatch.setattr("harness.backends.statement.find_spec", lambda _: object())
    _asked.cache_clear()
    assert statement("drake").missing == "asked again"
    _asked.cache_clear()


@pytest.mark.slow
def test_a_list_names_all_the_others_beside_one_that_exits(installed, capsys):
    installed("exits")
    assert main(["list", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["backends"]}
    assert rows["fcl"]["missing"] is None
    assert rows["odd"]["missing"] == WAYS["exits"]


def test_a_plan_that_depends_on_it_is_refused_with_the_reason(installed, capsys):
    installed("exits")
    assert main(["plan", "odd.yaml"]) == 2
    assert f'backend "odd" cannot be used: {WAYS["exits"]}' in capsys.readouterr().err
    with pytest.raises(registry.BackendError):
        approximation("odd", "sphere")


def test_nobody_takes_a_name_of_ours(tmp_path, monkeypatch):
    install(tmp_path, "exits")
    (tmp_path / "odd-1.0.dist-info" / "entry_points.txt").write_text("[harness.backends]\nfcl = odd_backend:Plugin\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert registry.ours("fcl")
    assert registry.create("fcl").name == "fcl"


@pytest.mark.parametrize("name", [name for name in registry.names() if registry.ours(name)])
def test_what_is_read_of_a_backend_is_what_it_says_once_it_is_imported(name):
    read, said = registry.abilities_of(name), statement(name)
    if said.missing is not None:
        pytest.skip(said.missing)
    assert read.queries == said.queries
    assert read.shapes in (None, tuple(said.tolerance))  # one that has another's shapes does not write them out
    assert set(read.gap_shapes or ()) <= set(said.tolerance)
