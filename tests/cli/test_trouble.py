"""A results file that cannot be written, through the real command: a sentence each, and nothing overwritten."""

import json
import os
import sqlite3
import subprocess
import sys

import pytest

from harness.cli.main import main
from harness.store import connection as store
from harness.store import tables
from harness.store.database import Database

EXPERIMENT = """
title: Trouble
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.2}
measure: {repeats: 3}
"""


@pytest.fixture
def trouble(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trouble.yaml").write_text(EXPERIMENT)
    return tmp_path / "results.db"


def refused(capsys, path, *words):
    """What the sweep says as it refuses the file, which stays as it is."""
    before = path.read_bytes()
    capsys.readouterr()
    assert main(["sweep", "trouble.yaml", "--db", str(path), *words]) == 2
    output = capsys.readouterr()
    assert "Traceback" not in output.err
    assert output.out == ""
    assert path.read_bytes() == before
    return output.err


def swept(path):
    assert main(["sweep", "trouble.yaml", "--db", str(path)]) == 0
    return path


@pytest.mark.slow
def test_a_full_disk_keeps_every_finished_run_and_the_next_sweep_does_the_rest(trouble, capsys, monkeypatch):
    connect = store._connect

    def cramped(path, mode):
        opened = connect(path, mode)
        if mode == "rwc":
            pages = os.path.getsize(path) // 4096 if path.exists() else 0
            opened.execute(f"PRAGMA max_page_count = {max(pages, 45)}")
        return opened

    with monkeypatch.context() as full:
        full.setattr(store, "_connect", cramped)
        assert main(["sweep", "trouble.yaml", "--db", str(trouble), "--set", "repeats=400", "--quiet"]) == 2
    error = capsys.readouterr().err
    assert "the disk is full" in error
    assert "the same command does the rest" in error
    kept = len(tables.runs(trouble))
    assert 0 < kept < 400
    assert main(["sweep", "trouble.yaml", "--db", str(trouble), "--set", f"repeats={kept + 1}"]) == 0
    assert f"1 runs done (1 ok), {kept} kept" in capsys.readouterr().out


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anything")
def test_a_read_only_file_is_refused(trouble, capsys):
    swept(trouble).chmod(0o444)
    assert "read-only" in refused(capsys, trouble)


@pytest.mark.slow
def test_a_locked_file_is_refused_after_a_while(trouble, capsys, monkeypatch):
    monkeypatch.setattr(store, "BUSY_SECONDS", 0.2)
    holder = sqlite3.connect(swept(trouble))
    holder.execute("BEGIN IMMEDIATE")
    assert "is locked" in refused(capsys, trouble, "--fresh")
    holder.close()


def test_a_second_sweep_on_one_file_is_refused_with_the_first_one_named(trouble, capsys):
    code = (
        "import sys; from harness.store.database import Database as D; D.open(sys.argv[1]); print(flush=True); input()"
    )
    swept(trouble)
    first = subprocess.Popen(
        [sys.executable, "-c", code, str(trouble)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    first.stdout.readline()
    try:
        assert f"another sweep is writing to it (process {first.pid} on" in refused(capsys, trouble)
    finally:
        first.communicate("")


@pytest.mark.parametrize(("change", "said"), [(1, "newer harness"), (-1, "older harness")])
def test_another_schema_version_is_refused(trouble, capsys, change, said):
    raw = sqlite3.connect(swept(trouble))
    raw.execute(f"PRAGMA user_version = {store.SCHEMA_VERSION + change}")
    raw.close()
    assert said in refused(capsys, trouble)


@pytest.mark.parametrize("damage", ["header", "middle", "truncated"])
def test_a_damaged_file_is_refused_and_left_as_it_is(trouble, capsys, damage):
    content = bytearray(swept(trouble).read_bytes())
    if damage == "header":
        content[:100] = os.urandom(100)
    elif damage == "middle":
        content[4096:24576] = bytes(20480)
    else:
        del content[len(content) // 2 :]
    trouble.write_bytes(content)
    assert "nothing was changed" in refused(capsys, trouble)


def test_a_file_of_another_program_is_refused(trouble, capsys):
    with sqlite3.connect(trouble) as other:
        other.execute("CREATE TABLE theirs (a)")
    other.close()
    assert "another program" in refused(capsys, trouble)
    trouble.write_text("no database at all\n")
    assert "not a results database" in refused(capsys, trouble)


def test_a_billion_bodies_are_refused_with_the_memory_they_would_need(trouble, capsys):
    huge = ["--set", "count=1000000000", "--set", "size={uniform: [0.5, 1]}", "--set", "box=[5000, 5000, 5000]"]
    assert main(["sweep", "trouble.yaml", "--db", str(trouble), *huge]) == 1
    assert "need at least 466 GiB" in capsys.readouterr().err
    assert {run.status for run in tables.run_records(trouble)} == {"rejected"}
    assert main(["plan", "trouble.yaml", *huge]) == 2
    assert "need at least 466 GiB" in capsys.readouterr().err


def test_a_sweep_leaves_no_lock_behind(trouble):
    swept(trouble)
    assert [name for name in os.listdir(trouble.parent) if "-sweep" in name] == []
    with Database.open(trouble):
        pass


def test_titles_are_shown_as_the_text_they_are(trouble, capsys):
    """Escaped in pages, and without the letters that would do something to a terminal."""
    title = json.dumps("<script>alert(1)</script>")
    (trouble.parent / "trouble.yaml").write_text(EXPERIMENT.replace("title: Trouble", f"title: {title}"))
    swept(trouble)
    assert main(["report", "--db", str(trouble), "--out", "pages"]) == 0
    for page in (trouble.parent / "pages").rglob("*.html"):
        assert "<script>alert" not in page.read_text()
    assert "&lt;script&gt;alert" in (trouble.parent / "pages/index.html").read_text()
