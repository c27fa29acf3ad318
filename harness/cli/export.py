"""`harness export`: every run in the database as CSV or JSON, for other programs."""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness import DATABASE
from harness.cli.streams import speaks_unicode
from harness.errors import InputError

if TYPE_CHECKING:
    from harness.store.records import ComparisonRecord, ExperimentRecord, RunRecord, VerdictRow

_FIXED = ("experiment", "repeat", "status", "reason")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("--db", type=Path, default=Path(DATABASE), help="the results (default: %(default)s)")
    parser.add_argument(
        "--format",
        choices=("csv", "json"),
        default="csv",
        help="csv: a row a run; json: also claims, expectations and comparisons (default: %(default)s)",
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="write it there instead of printing it")


def run(arguments: argparse.Namespace) -> int:
    """Export the results.

    Raises
    ------
    InputError
        The database cannot be read, or the file cannot be written.
    """
    from harness.store import tables
    from harness.whole_file import write_whole

    runs = tables.run_records(arguments.db)
    if arguments.format == "csv":
        text = _csv(runs)
    else:
        unicode = arguments.out is not None or speaks_unicode(sys.stdout)
        text = _json(runs, tables.experiments(arguments.db), tables.comparisons(arguments.db), unicode)
    if arguments.out is None:
        sys.stdout.write(text)
        return 0
    try:
        write_whole(arguments.out, text)
    except OSError as error:
        raise InputError(f"{arguments.out}: cannot be written: {error.strerror}") from error
    return 0


def _csv(runs: Sequence[RunRecord]) -> str:
    """A row a run. An empty cell is a metric that the run does not report, "nan" one that is not a number."""
    leaves = list(dict.fromkeys(leaf for run in runs for leaf in run.parameters))
    metrics = list(dict.fromkeys(name for run in runs for name in run.metrics))
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([*_FIXED, *leaves, *metrics])
    for run in runs:
        fixed = [getattr(run, name) for name in _FIXED]
        rows.writerow([*fixed, *(_cell(run.parameters.get(leaf)) for leaf in leaves), *map(run.metrics.get, metrics)])
    return text.getvalue()


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict) else value


def _json(
    runs: Sequence[RunRecord],
    experiments: Iterable[ExperimentRecord],
    comparisons: Iterable[ComparisonRecord],
    unicode: bool,
) -> str:
    """One document, with the comparisons of backends where there are any.

    JSON has neither infinity nor NaN: such a metric is null.
    """
    listed = list(experiments)
    document = {
        "runs": [
            {
                "experiment": run.experiment,
                "parameters": run.parameters,
                "repeat": run.repeat,
                "status": run.status,
                "reason": run.reason,
                "metrics": {name: value if math.isfinite(value) else None for name, value in run.metrics.items()},
            }
            for run in runs
        ],
        "claims": [_verdict(experiment.name, row) for experiment in listed for row in experiment.claims],
        "expectations": [_verdict(experiment.name, row) for experiment in listed for row in experiment.expectations],
    }
    compared = [
        {"experiment": found.experiment, "backends": list(found.backends), "found": found.document}
        for found in comparisons
    ]
    document |= {"comparisons": compared} if compared else {}
    return json.dumps(document, ensure_ascii=not unicode, allow_nan=False, indent=1) + "\n"


def _verdict(experiment: str, row: VerdictRow) -> dict[str, Any]:
    return {
        "experiment": experiment,
        "criterion": row.criterion,
        "verdict": row.verdict,
        "statement": row.statement,
        "detail": row.detail,
    }
