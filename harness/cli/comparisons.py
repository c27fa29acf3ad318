"""What a sweep compares once its runs are done: experiments that ask for it, several at a time on several cores.

A library that is wrong is a finding of the report, not a failure of the sweep; `harness compare` exits 1. What is timed
here is timed by the CPU time of a process of its own.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from harness.cli.crosscheck import (
    SHOWN,
    SWEPT,
    Asked,
    backends_of,
    cross_check,
    event_methods,
    kept,
    key_of,
    keys_of,
    pairs_of,
    reductions,
    timed_otherwise,
)
from harness.cli.surveying import SWEPT_SECONDS, engines, survey_key, surveyed
from harness.compare.budget import Budget
from harness.compare.document import Known
from harness.compare.outcome import TIMED, Comparison, Failure
from harness.experiment.experiment import Experiment
from harness.scene.scene_files import Opened
from harness.store.database import Database
from harness.vocabulary import EXACT_FRAMES
from harness.workers import shared_out, usable_cores

# s for the comparison of an experiment's methods within a sweep; `harness compare` takes as long as it takes.
_COMPARING = 30.0
# s besides, to ask libraries again what they answered in their runs.
_ASKING_AGAIN = 20.0

Pair = tuple[str, str]


@dataclass(frozen=True)
class _Compared:
    """What is kept of one experiment: of each pair its key and its document; and what is printed of it."""

    documents: list[tuple[Pair, str, dict[str, Any]]]
    lines: list[str]


@dataclass(frozen=True)
class _Task:
    """A comparison that is to be made.

    Parameters
    ----------
    said : when it begins
    """

    experiment: Experiment
    said: str
    make: Callable[[], _Compared]


def compare_asked(
    experiments: Sequence[Experiment], meshes: Opened, database: Database, *, command: str, fresh: bool, quiet: bool
) -> list[str]:
    """Compare where an experiment asks for it, unless that was done; each is kept as soon as it is made.

    Parameters
    ----------
    experiments, meshes : loaded and opened
    database : open for writing
    command : the command line that asks for it
    fresh : also what was compared before
    quiet : do not say what is being compared

    Returns
    -------
    list of str
        The outcome, a line each pair, or each engine of an atlas.
    """
    done = set() if fresh else database.history.compared()
    asking = [experiment for experiment in experiments if experiment.measure.families or experiment.measure.compare]
    # a survey takes longest, and so begins first
    asking.sort(key=lambda experiment: not experiment.measure.families)
    tasks = [task for experiment in asking for task in _tasks(experiment, meshes, database, done)]
    lines: dict[int, list[str]] = {}

    def begin(place: int) -> None:
        if not quiet:
            print(f"{tasks[place].experiment.name}: {tasks[place].said}", file=sys.stderr, flush=True)

    for place, compared in shared_out([task.make for task in tasks], usable_cores(), begin):
        experiment = tasks[place].experiment.name
        for pair, key, document in compared.documents:
            database.add_comparison(command, experiment, pair, key, document)
        lines[place] = [f"{experiment}: {line}" for line in compared.lines]
    return [line for _, mine in sorted(lines.items()) for line in mine]


def _tasks(experiment: Experiment, meshes: Opened, database: Database, done: Collection[str]) -> Iterator[_Task]:
    if experiment.measure.families:
        wanted = [name for name in engines() if survey_key(experiment, meshes, name) not in done]
        if wanted:
            yield _Task(experiment, f"asking {', '.join(wanted)}", partial(_survey, experiment, meshes, wanted))
        return
    names, _ = backends_of(experiment)
    events = event_methods(experiment)
    keys = {pair: key_of(experiment, meshes, pair, SWEPT) for pair in pairs_of(names, events)}
    left = {pair: key for pair, key in keys.items() if key not in done}
    if not left:
        return
    involved = {name for pair in left for name in pair}
    asked = {query: tuple(name for name in named if name in involved) for query, named in names.items()}
    asked_events = tuple(name for name in events if (EXACT_FRAMES, name) in left)
    said = dict.fromkeys((*(name for named in asked.values() for name in named), *asked_events))
    digests = database.history.values("event_digest", keys_of(experiment, meshes))
    make = partial(_cross_check, experiment, meshes, asked, asked_events, left, digests)
    yield _Task(experiment, f"comparing {', '.join(said)}", make)


def _cross_check(
    experiment: Experiment,
    meshes: Opened,
    asked: Asked,
    events: tuple[str, ...],
    keys: dict[Pair, str],
    digests: Mapping[str, Collection[float]],
) -> _Compared:
    """Hold the methods of an experiment against each other, and the timed runs of each against what it says here."""
    asking = Budget(_ASKING_AGAIN)
    otherwise = list(timed_otherwise(experiment, meshes, digests, asking))
    budget = Budget(_COMPARING)
    budget.left += asking.left
    known: Known = {}
    documents, lines, blamed = [], [], dict[str, None]()
    found_of = {
        pair: found
        for pair, found in cross_check(experiment, meshes, asked, SWEPT, budget=budget, events=events)
        if pair in keys
    }
    for name, reason in otherwise:
        pair = next((pair for pair in found_of if name in pair), None)
        if pair is not None:
            found_of[pair].failures.append(Failure(pair, name, TIMED, 0, reason, kind="otherwise when timed"))
    for pair, found in found_of.items():
        found.left_out += [line for line in budget.left_out if line not in found.left_out]
        rows = reductions(found, meshes, SHOWN, known)
        documents.append((pair, keys[pair], kept(experiment, found, rows)))
        lines.append(f"{' and '.join(pair)}: {_outcome(found)}")
        blamed |= {failure.sentence: None for failure in found.failures}
    return _Compared(documents, [*lines, *blamed, *(f"left out: {line}" for line in budget.left_out)])


def _outcome(found: Comparison) -> str:
    """What came of two methods, in a line."""
    verdicts = sum(tally.verdicts for tally in found.tallies)
    if not verdicts:
        return "; ".join(found.unsupported) or "no verdict was compared"
    both = f", both wrong in {len(found.shared)} that were judged" if found.shared else ""
    return f"{verdicts} verdicts, {len(found.cases)} really disagree{both}"


def _survey(experiment: Experiment, meshes: Opened, wanted: Sequence[str]) -> _Compared:
    """Ask the engines about families of poses."""
    seconds = SWEPT_SECONDS if experiment.measure.tier == "default" else None
    found = surveyed(experiment, meshes, wanted, Budget(seconds))
    documents, lines = [], []
    for pair, document in found.documents():
        engine, _ = pair
        documents.append((pair, survey_key(experiment, meshes, engine), document))
        mine = [cell for cell in found.atlas.cells if cell.engine == engine]
        verdicts, beyond = sum(cell.verdicts for cell in mine), sum(cell.beyond for cell in mine)
        lines.append(f"{engine}: {verdicts} verdicts, {beyond} wrong beyond its tolerance")
    return _Compared(documents, [*lines, *(f"left out: {line}" for line in found.found.left_out)])
