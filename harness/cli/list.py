"""Print experiments, backends, algorithms, queries and who answers them, and metrics with their units."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from harness.cli.width import say
from harness.experiment import FOLDER
from harness.vocabulary import ALGORITHMS, QUERIES, Query, algorithms_of

if TYPE_CHECKING:
    from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="one JSON document on standard output")
    form.add_argument("--schema", action="store_true", help="the JSON Schema of experiment files, for editors")


def run(arguments: argparse.Namespace) -> int:
    """Print the experiments, backends, algorithms, queries and metrics that there are."""
    import json

    if arguments.schema:
        from harness.experiment.json_schema import json_schema

        print(json.dumps(json_schema(), indent=2))
        return 0
    backends = _backends()
    listing: dict[str, list[dict[str, Any]]] = {
        "experiments": _experiments(),
        "backends": backends,
        "algorithms": [{"name": name, "description": word.meaning} for name, word in ALGORITHMS.items()],
        "queries": _queries(backends),
        "metrics": _metrics(),
    }
    if arguments.json:
        print(json.dumps(listing, indent=2))
        return 0
    _print("Experiments", [(row["name"], _experiment_line(row)) for row in listing["experiments"]])
    _print("Backends", [line for row in listing["backends"] for line in _backend_lines(row)])
    _print("Algorithms", [(row["name"], row["description"]) for row in listing["algorithms"]])
    _print("Queries", [line for row in listing["queries"] for line in _query_lines(row)])
    _print("Metrics", [(row["name"], f"{row['unit']:4}  {row['description']}") for row in listing["metrics"]])
    return 0


def _experiments() -> list[dict[str, Any]]:
    """Every experiment of the folder; of one that is wrong, how many problems it has; and what it lacks here."""
    from pathlib import Path

    from harness.errors import InputError
    from harness.experiment.files import find_experiments
    from harness.experiment.kept_facts import kept_facts

    if not Path(FOLDER).is_dir():
        return []
    try:
        paths = find_experiments([FOLDER])
    except InputError:
        return []
    return [kept_facts("list", path, {}) or _experiment(path) for path in paths]


def _experiment(path: Path) -> dict[str, Any]:
    """What is listed of a file, which is read; of a valid one it is kept."""
    from harness.errors import InputError, NotInstalledError
    from harness.experiment.files import name_of
    from harness.experiment.kept_facts import keep_facts
    from harness.experiment.load import load

    row: dict[str, Any] = {"name": name_of(path), "path": str(path), "missing": None}
    try:
        experiment = load(path)
    except NotInstalledError as error:
        missing = "; ".join(dict.fromkeys(problem.message for problem in error.problems))
        return row | {"title": None, "points": None, "runs": None, "tier": None, "problems": 0, "missing": missing}
    except InputError as error:
        return row | {"title": None, "points": None, "runs": None, "tier": None, "problems": len(error.problems)}
    points, tier = len(experiment.points), experiment.measure.tier
    row |= {"title": experiment.title, "points": points, "runs": experiment.runs, "tier": tier, "problems": 0}
    keep_facts("list", path, {}, experiment.source, experiment.mesh_paths, experiment.poses_paths, row)
    return row


def _experiment_line(row: dict[str, Any]) -> str:
    if row["problems"]:
        return f"wrong: `harness validate {row['path']}` says how"
    if row["missing"]:
        return f"passed over: {row['missing']}"
    long = ", long" if row["tier"] == "long" else ""
    return f"{row['title']} ({row['runs']} run{'s' * (row['runs'] != 1)}{long})"


def _backends() -> list[dict[str, Any]]:
    """Every declared backend: why it is missing and what brings it, or what it says of itself."""
    from harness.backends.registry import install_command, names
    from harness.backends.statement import statement

    rows = []
    for name in names():
        said = statement(name)
        row: dict[str, Any] = {"name": name, "missing": said.missing, "install": install_command(name)}
        if said.missing is None:
            row |= {"shapes": list(said.tolerance), "tolerance": dict(said.tolerance), "units": said.units or None}
            row |= {"precision": said.precision or None, "approximations": dict(said.approximations)}
            row |= {"queries": list(said.queries)}
        rows.append(row)
    return rows


def _backend_lines(row: dict[str, Any]) -> list[tuple[str, str]]:
    """One line, and below it what a person should know of an installed one."""
    if row["missing"]:
        return [(row["name"], f"missing: {row['missing']}")]
    bands = ", ".join(f"{shape} to {band:g} of size" for shape, band in row["tolerance"].items())
    notes = [f"precision: {row['precision']}"] if row["precision"] else []
    notes += [f"units: {row['units']}"] if row["units"] else []
    notes += row["approximations"].values()
    return [(row["name"], f"installed; {bands}"), *(("", note) for note in notes)]


def _queries(backends: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Every query, with the algorithms of this program that answer it, and the installed backends that do by theirs."""

    def own(name: str, query: Query) -> bool:
        return not all(ALGORITHMS[algorithm].own for algorithm in algorithms_of(name, query))

    return [
        {
            "name": query,
            "description": meaning,
            "algorithms": [name for name, word in ALGORITHMS.items() if word.own and query in word.queries],
            "backends": [
                row["name"] for row in backends if query in row.get("queries", ()) and own(row["name"], query)
            ],
        }
        for query, meaning in QUERIES.items()
    ]


def _query_lines(row: dict[str, Any]) -> list[tuple[str, str]]:
    answered = f"answered by {', '.join(row['algorithms'])}; by itself, of backends: {', '.join(row['backends'])}"
    return [(row["name"], row["description"]), ("", answered)]


def _metrics() -> list[dict[str, Any]]:
    from harness.measure.metrics import METRICS

    return [{"name": name, "unit": metric.unit, "description": metric.description} for name, metric in METRICS.items()]


def _print(heading: str, rows: list[tuple[str, str]]) -> None:
    print(heading)
    width = max((len(name) for name, _ in rows), default=0)
    for name, text in rows or [("none", "")]:
        say(f"  {name:{width}}  {text}".rstrip())
    print()
