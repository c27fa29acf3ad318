"""A results file like those of sweeps, with invented times: every kind of experiment a report must cope with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.measure.metrics import METRICS
from harness.store.database import Database
from harness.store.records import PointRow, VerdictRow

MACHINE = {
    "processor": "Example CPU 9",
    "cores": 2,
    "memory": 8_000_000_000,
    "system": "Linux 6.1",
    "python": "CPython 3.11",
}
PACKAGES = {"harness": "0.1.0", "numpy": "2.0.0", "python-fcl": "0.7.0"}
SCENE = {
    "mesh": "pumpkin-1753.ply", "shape": "mesh", "count": 10, "size": 1.0, "box_ratio": 0.01, "seed": 259,
    "duration": 10.0, "dt": 1 / 60, "response": "reflect", "backend": "fcl", "algorithm": "brute-force",
    "tolerance": 1e-6, "faces": 1753, "packing": 0.005, "box_side": 10.0,
}  # fmt: skip
STAGES = [
    {"name": "pairs", "kept": True, "why": "10 bodies can meet"},
    {"name": "rotations", "kept": False, "why": "spheres look the same from all sides"},
]
NUMBER = """5 85.1 4780 .000031 14340 .000193;10 84.9 33075 .000211 44100 .000356;15 83.5 83552 .000478 74598 .0005;
20 82 88803 .000674 62490 .000542;25 81.3 102718 .0012718 56028 .00073;30 80.2 145530 .001803 64680 .000899;
35 79.1 195360 .002562 73260 .001097;40 73.2 188404 .003192 61104 .00137;45 68.5 247422 .00444 70692 .001345;
50 65 328248 .005504 83808 .001616"""
FACES = """1753 81.5 188404 .003192 61104 .00137;9868 51.5 606870 .004221 165510 .002422;
17001 15 526922 .007065 147048 .001995"""
SIZES = "0.01 84.9 33075 .000211 44100 .000356;0.04 84 40950 .000663 54600 .00373;0.25 51.5 40950 .013747 54600 .002909"


def published(leaf: str, text: str) -> dict[str, Any]:
    """A `published:` block from lines of numbers."""
    names = (leaf, "frames_per_second", "pair_tests", "pair_seconds_per_frame", "box_tests", "box_seconds_per_frame")
    rows = [dict(zip(names, map(float, line.split()), strict=True)) for line in text.split(";")]
    return {"source": "COMP259 homework 2", "note": None, "rows": rows}


def measure(parameters: Mapping[str, Any], rng: np.random.Generator, factor: float = 1.0) -> dict[str, float]:
    """What a run of these parameters would report, with noise of a few per cent on the clocks."""
    count, frames = float(parameters["count"]), round(parameters["duration"] / parameters["dt"])
    power, base = {"brute-force": (2.0, 1e-6), "grid": (1.1, 2e-5), "predictive": (1.0, 5e-5)}.get(
        parameters["algorithm"], (1.2, 4e-5)
    )
    noise = 1.0 + 0.02 * rng.standard_normal(3)
    pair = frames * base * count**power * noise[0] * factor * (parameters.get("faces", 1753) / 1753) ** 0.2
    box, response = frames * 2e-6 * count * noise[1], frames * 1e-7 * count * noise[2]
    run = pair + box + response
    clocks = {
        "pair_seconds": pair,
        "box_seconds": box,
        "response_seconds": response,
        "run_seconds": run,
        "setup_seconds": 0.02,
    }
    clocks |= {
        "pair_seconds_per_frame": pair / frames,
        "box_seconds_per_frame": box / frames,
        "frames_per_second": frames / run,
    }
    clocks |= {f"{name}_elapsed": value * 1.04 for name, value in clocks.items()}
    counters = {"frames": frames, "pair_tests": frames * count * (count - 1) / 2, "box_tests": 6 * frames * count}
    counters |= {
        "pair_hits": count * 3,
        "box_hits": count * 7,
        "energy_drift": 2.2e-16,
        "escaped": 0,
        "peak_memory": 9e7,
    }
    return {**counters, **clocks}


@dataclass
class Invented:
    """One experiment to be written: `fate` may turn a run into a failure, or change its metrics."""

    name: str
    title: str
    swept: Mapping[str, Sequence[Any]]
    base: Mapping[str, Any]
    repeats: int = 5
    question: str | None = None
    report: Mapping[str, Any] | None = None
    published: Mapping[str, Any] | None = None
    reference: Mapping[str, Any] | None = None
    claims: Sequence[VerdictRow] = ()
    expectations: Sequence[VerdictRow] = ()
    fate: Callable[[Mapping[str, Any], int, dict[str, float]], tuple[str, str] | None] = lambda *_: None
    warnings: Callable[[Mapping[str, Any]], list[str]] = lambda _: []

    @property
    def points(self) -> list[dict[str, Any]]:
        """All points: the product of the swept lists; a list of mappings stands for leaves that vary together."""
        found = []
        for values in product(*self.swept.values()):
            point = {**SCENE, **self.base}
            for leaf, value in zip(self.swept, values, strict=True):
                point |= value if leaf == "zip" else {leaf: value}
            found.append(point)
        return found


def write(path: Path, experiments: Sequence[Invented]) -> Path:
    """Write a results file through the store."""
    rng = np.random.default_rng(1)
    with Database.open(path) as database:
        sweep = database.begin_sweep("harness sweep experiments", "0123456789abcdef", "0.1.0", MACHINE, PACKAGES)
        for invented in experiments:
            specification = {
                "expect": [], "claims": [], "published": invented.published, "report": invented.report,
                "swept": [leaf for leaf in invented.swept if leaf != "zip"]
                + list((invented.swept.get("zip") or [{}])[0]),
                "measure": {"repeats": invented.repeats, "reference": invented.reference},
            }  # fmt: skip
            points = [
                PointRow(f"{invented.name}-{place}", point, {"stages": STAGES, "warnings": invented.warnings(point)})
                for place, point in enumerate(invented.points)
            ]
            source = f"title: {invented.title}\nscene:\n  count: 5   # bodies\n"
            number = database.list_experiment(
                sweep, invented.name, invented.title, invented.question, source, specification, points
            )
            for point in points:
                for repeat in range(invented.repeats):
                    metrics = measure(point.parameters, rng)
                    status, reason = invented.fate(point.parameters, repeat, metrics) or ("ok", None)
                    kept = (
                        {name: (value, METRICS[name].unit) for name, value in metrics.items()} if status == "ok" else {}
                    )
                    database.add_run(sweep, point.key, repeat, status, reason, None, kept, True)
            add_controls(database, sweep, invented, points)
            database.add_verdicts(sweep, number, "claim", invented.claims)
            database.add_verdicts(sweep, number, "expectation", invented.expectations)
        database.finish_sweep(sweep)
    return path


def add_controls(database: Database, sweep: int, invented: Invented, points: Sequence[PointRow]) -> None:
    """Of each repeat one run once more, where there are five, as a sweep does it."""
    rng = np.random.default_rng(2)
    for repeat in range(invented.repeats if invented.repeats >= 5 else 0):
        point = points[(2 * repeat + 1) * len(points) // (2 * invented.repeats)]
        metrics = measure(point.parameters, rng)
        status, _ = invented.fate(point.parameters, repeat, metrics) or ("ok", None)
        clocks = {name: value for name, value in metrics.items() if METRICS[name].clock}
        database.add_control(sweep, point.key, repeat, status, clocks if status == "ok" else {})


def claim(verdict: str, statement: str, groups: int = 1, source: str | None = "homework B.1") -> VerdictRow:
    """A verdict with as many groups."""
    detail = {
        "groups": [{"parameters": {"count": place}, "verdict": verdict, "statement": "x"} for place in range(groups)]
    }
    criterion = {"metric": "pair_seconds"} | ({"source": source} if source else {})
    return VerdictRow(criterion, verdict, statement, detail)


HELD = claim("holds", "pair_seconds grows as count^2.00 [1.99, 2.01]: between 1.8 and 2.2")
DRIFT = claim("holds", "energy_drift is at most 1e-12 in all 50 runs", source=None)


def _slow(parameters: Mapping[str, Any], repeat: int, metrics: dict[str, float]) -> tuple[str, str] | None:
    if parameters["algorithm"] == "brute-force" and parameters["count"] == 1000:
        return "timeout", "stopped after 120 s <of> CPU time"
    return None


NUMBER_OF_OBJECTS = Invented(
    "homework/number-of-objects", "Cost against the number of objects", {"count": [*range(5, 55, 5)]}, {},
    question="Does the time for object/object tests grow with the square of the number of objects?",
    report={"x": "count", "y": ["pair_seconds", "box_seconds"]}, published=published("count", NUMBER),
    claims=[HELD, claim("fails", "box_seconds falls with count"), claim("undecided", "it straddles a limit", 3)],
    expectations=[DRIFT],
)  # fmt: skip
COMPLEXITY = Invented(
    "homework/complexity", "Cost against the faces of an object",
    {"zip": [{"mesh": f"pumpkin-{faces}.ply", "faces": faces} for faces in (1753, 9868, 17001)]}, {"count": 45},
    report={"x": "faces", "y": ["pair_seconds"]}, published=published("faces", FACES), claims=[HELD],
)  # fmt: skip
OBJECT_SIZE = Invented(
    "homework/object-size", "Cost against crowding", {"box_ratio": [0.01, 0.04, 0.25]}, {},
    published=published("box_ratio", SIZES),
)  # fmt: skip
ALGORITHMS = Invented(
    "homework/algorithms", "Three algorithms on the same scenes",
    {"algorithm": ["brute-force", "grid", "predictive"], "count": [10, 30, 100, 300, 1000],
     "box_ratio": [0.01, 0.04, 0.25]},
    {"shape": "sphere"}, question="Which algorithm is fastest, and from how many bodies on?",
    report={"x": "count"}, fate=_slow,
)  # fmt: skip
BACKENDS = Invented(
    "backends", "Backends on real meshes",
    {"backend": ["fcl", "pybullet"], "mesh": ["bunny.obj", "duck.obj", "soccerball.obj"]}, {"algorithm": "native"},
    warnings=lambda point: ["shape mesh on backend pybullet is a hull"] if point["backend"] == "pybullet" else [],
    expectations=[claim("fails", "pair_hits is 30 in 3 of 6 points")],
)  # fmt: skip
HOSTILE = Invented(
    "odd/../<script>", "<script>alert(1)</script>", {"mesh": ["<b>a</b>.ply", "b&c.ply"]}, {},
    question="Is <img src=x onerror=alert(1)> text?", claims=[claim("fails", "<i>never</i>", source="<u>me</u>")],
)  # fmt: skip
SINGLE = Invented("single", "One scene, one run", {}, {}, repeats=1)
BROKEN = Invented("broken", "Nothing came to its end", {"count": [5, 50]}, {}, fate=lambda *_: ("crashed", "signal 11"))
FEW = Invented("few", "Three repeats", {"count": [5, 50], "backend": ["fcl", "pybullet"]}, {}, repeats=3)
ALL = [NUMBER_OF_OBJECTS, COMPLEXITY, OBJECT_SIZE, ALGORITHMS, BACKENDS, HOSTILE, SINGLE, BROKEN, FEW]


@pytest.fixture(scope="session")
def database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results file with every kind of experiment."""
    return write(tmp_path_factory.mktemp("results") / "results.db", ALL)


@pytest.fixture(scope="session")
def pages(database: Path) -> dict[str, str]:
    """Every file of the report of `database`, by its path."""
    from harness.report.site import render

    return dict(render(database))


@pytest.fixture
def report_of(tmp_path: Path) -> Callable[..., dict[str, str]]:
    """Every file of the report of one invented experiment, given as the fields of `Invented`."""

    def made(**fields: Any) -> dict[str, str]:
        from harness.report.site import render

        defaults = {"name": "x", "title": "X", "swept": {"count": [10, 40, 160]}, "base": {}}
        return dict(render(write(tmp_path / "x.db", [Invented(**(defaults | fields))])))

    return made
