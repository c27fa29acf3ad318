"""The page of the atlas: what was asked stands beside what it was asked of, and all bodies are counted together."""

import re
from datetime import datetime, timezone
from html import unescape

from harness.report.site import render
from harness.store.database import Database
from harness.store.records import PointRow


def cell(family, mesh, query=None, wrong=0, beyond=0, deepest=0.0):
    made = {"engine": "fcl", "family": family, "shape": "hull", "mesh": mesh, "verdicts": 1000, "wrong": wrong}
    made |= {"beyond": beyond, "deepest": deepest, "seconds": 1e-6, "failures": 0, "case": None}
    made |= {"per_million": 1e3 * wrong, "low": 0.0, "high": 1.0}
    return made | ({"query": query} if query else {})


def page(path, cells):
    empty = {name: [] for name in ("pairs", "cases", "shared", "unsupported", "left_out", "shown")}
    with Database.open(path) as database:
        document = empty | {"atlas": cells, "title": "Atlas", "versions": {}}
        database.add_comparison("harness compare", "atlas/mine", ("fcl", "exact arithmetic"), "key", document)
    pages = dict(render(path))
    return pages, unescape(re.sub(r"<[^>]+>", "|", pages["atlas.html"])).replace("\u00a0", " ").replace("\u202f", "")


def test_verdicts_on_several_meshes_are_counted_together(tmp_path):
    cells = [cell("random", "cube.ply", wrong=3, beyond=1, deepest=0.25), cell("random", "needle.off", wrong=1)]
    pages, text = page(tmp_path / "x.db", cells)  # of before other queries: these cells name none
    assert "2000 verdicts, each held against exact arithmetic: 4 are wrong, 1 of them" in text
    assert "All bodies together" in text
    assert "fcl in 1 of 2000 (random)" in unescape(pages["atlas-collision-all-bodies.svg"]).replace("\u202f", "")


def test_gaps_have_sentences_and_matrices_of_their_own(tmp_path):
    cells = [cell("far", "cube.ply"), cell("far", "cube.ply", "distance", wrong=9, beyond=2, deepest=0.5)]
    pages, text = page(tmp_path / "x.db", cells)
    assert "1000 verdicts, each held against exact arithmetic: 0 are wrong" in text
    assert "Asked for the distance: 1000 answers, each held against exact distances: 2 are off" in text
    assert "fcl is off by more than its tolerance in 2 answers on distance, by 0.5" in text
    assert "All bodies together" not in text
    assert len([name for name in pages if name.startswith("atlas-") and name.endswith(".svg")]) == 2


def test_an_experiment_with_families_has_found_what_the_engines_said_and_no_times_of_a_run_without_frames(tmp_path):
    path = tmp_path / "x.db"
    leaves = {"backend": "fcl", "algorithm": "grid", "shape": "hull", "mesh": "cube.ply", "count": 2}
    with Database.open(path) as database:
        number = database.begin_sweep("harness sweep", None, "0.1.0", {"fingerprint": "m"}, {})
        specification = {"measure": {"families": ["random"], "repeats": 1}}
        database.list_experiment(number, "atlas/mine", "Mine", "?", "", specification, [PointRow("p", leaves)])
        metrics = {"run_seconds": (0.0, "s"), "events": (0.0, "1")}
        database.add_run(
            number, "p", 0, "ok", None, None, metrics, True, started=datetime.now(timezone.utc)
        )  # fmt: skip
        database.finish_sweep(number)
    told = dict(render(path))["findings.md"]
    assert "0 s" not in told
    assert "Nothing was measured yet." in told
    page(path, [cell("random", "cube.ply", wrong=3, beyond=1, deepest=0.25)])
    told = dict(render(path))["findings.md"].replace("\u202f", "").replace("\u00a0", " ")
    assert "1000 verdicts, each held against exact arithmetic: 3 are wrong, 1 of them by more than the engine's" in told
