"""A results file that cannot be written, through the real command: a sentence each, and nothing overwritten."""

import json
import os
import shlex
import sqlite3
import subprocess
import sys

import pytest

from harness.cli.main import main
from harness.store import connection as store
from harness.store import tables
from harness.store.database import Database
from tests.conftest import slow_beyond

EXPERIMENT = """
title: Trouble
scene: {shape: sphere, count: 4, box: [5, 5, 5]}
motion: {duration: 0.2}
measure: {repeats: 1}
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
    assert f"1 run done (1 ok), {kept} kept" in capsys.readouterr().out


@pytest.mark.parametrize(
    "name",
    slow_beyond(
        ["it's \"q\".db", "-dash.db", "sub folder#/x?.db", "per%41cent%.db", "a b.db", "h#sh.db", "wh?t.db",
         "new\nline.db", "tab\t.db", "back\\.db", "$HOME;&.db", "ünï ⇒.db", "file:x.db", " .db"],
        4,
    ),
)  # fmt: skip
def test_a_results_file_may_be_called_anything(trouble, capsys, name):
    """The file that is named is made, and read again, by the words that the sweep itself gives to go on."""
    path = trouble.parent / name
    assert main(["sweep", "trouble.yaml", f"--db={name}", "--set", "repeats=1"]) == 0
    said = capsys.readouterr().out
    assert path.is_file()
    assert {each.name for each in path.parent.iterdir()} <= {
        path.name,
        f"{path.name}-wal",
        f"{path.name}-shm",
        "trouble.yaml",
    }
    words = shlex.split(said.partition("Now `harness ")[2].rpartition("` turns")[0])
    assert words[0] == "report"
    assert main(["export", *words[1:], "--format", "json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["runs"]) == 1
    assert main(["sweep", "trouble.yaml", f"--db={name}", "--set", "repeats=1"]) == 0
    assert "0 runs done, 1 kept from before" in capsys.readouterr().out


@pytest.mark.parametrize("becomes", ["nothing", "another", "shorter"])
def test_a_file_that_goes_while_a_sweep_writes_is_said(trouble, capsys, monkeypatch, becomes):
    swept(trouble)
    added = Database.add_run

    def add_run(database, *arguments, **options):
        added(database, *arguments, **options)
        if becomes == "nothing":
            trouble.unlink()
        elif becomes == "another":
            trouble.rename(f"{trouble}.away")
            trouble.write_bytes(b"")
        else:
            os.truncate(trouble, 5000)

    monkeypatch.setattr(Database, "add_run", add_run)
    assert main(["sweep", "trouble.yaml", "--db", str(trouble), "--quiet", "--fresh", "--set", "repeats=2"]) == 2
    said = capsys.readouterr().err
    assert ("was removed or replaced while it was written to" if becomes != "shorter" else "is damaged") in said


@pytest.mark.slow
def test_two_sweeps_and_a_report_at_once_on_one_file(trouble, capsys):
    """One of the sweeps does its runs, the other is refused; reports and exports show what is finished."""
    command = [sys.executable, "-m", "harness", "sweep", "trouble.yaml", "--db", "results.db", "--set", "repeats=20"]
    swept(trouble)
    sweeps = [
        subprocess.Popen([*command, "--fresh"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    while all(sweep.poll() is None for sweep in sweeps):
        assert main(["export", "--db", "results.db"]) == 0
    assert main(["report", "--db", "results.db", "--out", "pages"]) == 0
    ended = sorted((sweep.wait(), *sweep.communicate()) for sweep in sweeps)
    assert [code for code, *_ in ended] == [0, 2]
    assert "20 runs done (20 ok)" in ended[0][1]
    assert "another sweep is writing to it (process " in ended[1][2]
    assert len(tables.runs(trouble)) == 20
    with sqlite3.connect(trouble) as raw:
        assert raw.execute("PRAGMA integrity_check").fetchone() == ("ok",)


@pytest.mark.slow
def test_two_reports_of_one_file_are_the_same_byte_for_byte(trouble):
    """Made by processes whose sets are in another order, in other folders, of other names, at other times."""
    swept(trouble)
    pages = []
    for seed, folder in (("0", "one"), ("4321", "two/deep er")):
        command = [sys.executable, "-m", "harness", "report", "--db", str(trouble), "--out", folder]
        environment = os.environ | {"PYTHONHASHSEED": seed, "TZ": f"UTC-{seed[:1]}"}
        subprocess.run(command, env=environment, check=True, capture_output=True)
        files = [path for path in (trouble.parent / folder).rglob("*") if path.is_file()]
        pages.append({str(path.relative_to(trouble.parent / folder)): path.read_bytes() for path in files})
    assert pages[0] == pages[1]
    assert "index.html" in pages[0]


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


@pytest.mark.slow
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
