"""Compare backends with each other, and with exact arithmetic, on the same poses.

The bodies of each scene fly through each other, whatever its response, and every backend is asked about every frame
what `engine.query` says: which bodies touch, which are near, how far apart they are, or when they begin to touch.
Scenes of random bodies are followed by pairs at first contact, where verdicts are hardest. Where the experiment has a
response, its first such scene is run as well by every backend for itself: the time of the first hit that only one of
two answers is told, and the averages of both runs after it. What is found is kept in the database, and
`harness report` shows it. Exits 1 if a backend is wrong beyond what its tolerance or its approximation explains, or
fails at a pose.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from harness import DATABASE
from harness.cli.arguments import comma_separated, positive_count, positive_seconds
from harness.cli.overrides import add_override_argument, overrides_of
from harness.cli.width import say
from harness.errors import InputError

if TYPE_CHECKING:
    from harness.cli.surveying import Surveyed
    from harness.compare.document import Reduced
    from harness.compare.outcome import Case, Comparison
    from harness.compare.tally import Counts
    from harness.experiment.experiment import Experiment
    from harness.scene.scene_files import Opened


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument("paths", metavar="PATH", nargs="+", help="experiment files, or folders of them")
    parser.add_argument(
        "--backends",
        metavar="A,B",
        help="two or more, such as fcl,fcl/grid,pybullet: a method of this program as BACKEND/ALGORITHM, a backend "
        "alone for its own pipeline; those of the experiment where it names several, else fcl,pybullet",
    )
    parser.add_argument(
        "--budget",
        metavar="SECONDS",
        type=positive_seconds,
        help="stop asking after so long, and say what was left out",
    )
    parser.add_argument(
        "--every", metavar="N", type=positive_count, default=1, help="ask about every N-th pose only, and say so"
    )
    add_override_argument(parser)
    parser.add_argument(
        "--save",
        metavar="DIR",
        help="write real disagreements as the smallest experiments that show them, and of an atlas its table and the "
        "proof of every accusation",
    )
    parser.add_argument("--db", metavar="FILE", help=f"the database that keeps the verdicts (default: {DATABASE})")
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


@dataclass
class _Findings:
    """What was found of all experiments.

    Parameters
    ----------
    whole : all of it together
    rows : its cases, each with whether it is a real disagreement
    kept : what the database keeps: experiment, who was compared, the key of what was asked, and the document
    atlases : of the experiments that have families
    """

    whole: Comparison
    rows: list[tuple[Reduced, bool]] = field(default_factory=list)
    kept: list[tuple[str, tuple[str, str], str, dict[str, Any]]] = field(default_factory=list)
    atlases: list[Surveyed] = field(default_factory=list)

    @property
    def ordered(self) -> list[Reduced]:
        """Its cases as `document` has them: what one backend loses first, then what both share."""
        return [row for row, real in self.rows if real] + [row for row, real in self.rows if not real]


def run(arguments: argparse.Namespace) -> int:
    """Compare, print, and tell by the exit code whether a backend was wrong."""
    from harness.runner.preparation import prepare

    chosen = _chosen(arguments.backends)
    experiments, meshes = prepare(arguments.paths, overrides_of(arguments), _progress)
    if arguments.db is not None:
        _open(arguments.db).close()  # before the work, not after it
    if arguments.save:
        _make_folder(arguments.save)
    found = _compared(experiments, meshes, chosen, arguments)
    ordered, files = found.ordered, dict[int, str]()
    unsaved: OSError | None = None
    if arguments.save:
        try:
            _save(ordered, meshes, arguments.save, files)
            _save_atlases(found.atlases, ordered, files, arguments.save)
        except OSError as error:  # what was found is said and kept all the same
            unsaved = error
    _show(found, files, as_json=arguments.json)
    _keep(found.kept, arguments.db)
    if unsaved is not None:
        raise _unwritable(unsaved, arguments.save)
    return 0 if found.whole.passed else 1


def _progress(line: str) -> None:
    print(line, file=sys.stderr)


def _compared(
    experiments: Sequence[Experiment], meshes: Opened, chosen: tuple[str, ...], arguments: argparse.Namespace
) -> _Findings:
    """Ask everyone about every experiment, and make the cases smaller."""
    from harness.cli.crosscheck import (
        SAVED,
        SHOWN,
        WHOLE,
        backends_of,
        cross_check,
        event_methods,
        kept,
        key_of,
        reductions,
    )
    from harness.cli.surveying import engines, survey_key, surveyed
    from harness.compare.budget import Budget
    from harness.compare.document import Known
    from harness.compare.outcome import Comparison
    from harness.workers import usable_cores

    found_of_all, known = _Findings(Comparison()), Known()
    whole, rows = found_of_all.whole, found_of_all.rows
    budget = Budget(arguments.budget, arguments.every)
    if budget.every > 1:
        budget.leave_out(f"of the poses of each scene one in {budget.every} was asked about")
    for experiment in experiments:
        if experiment.measure.families:
            atlas = surveyed(experiment, meshes, engines(chosen), budget, _progress, usable_cores())
            whole.add(atlas.found)
            rows += [(row, True) for row in atlas.rows]
            found_of_all.atlases.append(atlas)
            found_of_all.kept += [
                (experiment.name, (engine, judge), survey_key(experiment, meshes, engine), document_of)
                for (engine, judge), document_of in atlas.documents()
            ]
            continue
        names, lacking = backends_of(experiment, chosen)
        events = event_methods(experiment, chosen)
        whole.unsupported += lacking
        all_names = dict.fromkeys(name for asked in names.values() for name in asked)
        _progress(f"{experiment.name}: {', '.join((*all_names, *events))}")
        for pair, found in cross_check(experiment, meshes, names, WHOLE, _progress, budget, events):
            small = reductions(found, meshes, SAVED if arguments.save else SHOWN, known)
            rows += [(row, place < len(found.cases)) for place, row in enumerate(small)]
            found_of_all.kept.append(
                (experiment.name, pair, key_of(experiment, meshes, pair, WHOLE, budget), kept(experiment, found, small))
            )
            whole.add(found)
    whole.left_out += [line for line in budget.left_out if line not in whole.left_out]
    return found_of_all


def _show(found: _Findings, files: dict[int, str], *, as_json: bool) -> None:
    """Print what was found, with the files that were saved."""
    from harness.cli.surveying import cell_row, cell_text
    from harness.compare.document import document

    ordered, whole = found.ordered, found.whole
    cells = [cell for atlas in found.atlases for cell in atlas.atlas.cells]
    if as_json:
        atlas = {"atlas": [cell_row(cell) for cell in cells]} if cells else {}
        json.dump(document(whole, ordered, files) | atlas, sys.stdout, allow_nan=False)
        print()
        for line in whole.unsupported + whole.left_out:
            _progress(line)
    else:
        for cell in cells:
            print(cell_text(cell))
        _print(whole)
    for row in ordered:
        if row.tried and row.small is None:
            case = row.case
            seen = f"{case.wrong}, {case.pose.name}, call {case.query_index}"
            _progress(f"{seen}: asked afresh, it was not found again; it may depend on what was asked before")


def _chosen(text: str | None) -> tuple[str, ...]:
    """The backends and methods that `--backends` names."""
    from harness.backends.registry import names
    from harness.experiment.messages import listed, near, shown
    from harness.vocabulary import ALGORITHMS, QUERIES, PipelineName, algorithms_of

    if text is None:
        return ()
    chosen = tuple(dict.fromkeys(comma_separated(text)))
    for name in chosen:
        backend, algorithm = PipelineName.read(name)
        if backend not in names():
            hint = near(backend, names()) or f"; there are {listed(names())}"
            raise InputError(f"--backends: unknown backend {shown(backend)}{hint}")
        # of queries other than collision also the backend's own; which experiments ask is known when they are read
        possible = [word for query in QUERIES for word in algorithms_of(backend, query) if ALGORITHMS[word].stepped]
        possible = list(dict.fromkeys(possible))
        if algorithm is not None and algorithm not in possible:
            hint = near(algorithm, possible) or (f"; there are {listed(possible)}" if possible else "")
            raise InputError(f"--backends: {backend} cannot be asked at poses with algorithm {shown(algorithm)}{hint}")
    if len(chosen) < 2:
        raise InputError("--backends: two backends at least, such as fcl,pybullet")
    return chosen


def _open(path: str) -> Any:
    from harness.store.database import Database

    return Database.open(path)


def _keep(found: list[tuple[str, tuple[str, str], str, dict[str, Any]]], chosen: str | None) -> None:
    """Into the database. One that was not asked for and cannot be used costs a warning, not the comparison."""
    import shlex

    try:
        with _open(chosen or DATABASE) as database:
            for name, pair, key, document in found:
                database.add_comparison(shlex.join(["harness", *sys.argv[1:]]), name, pair, key, document)
    except InputError as error:
        if chosen is not None:
            raise
        print(f"the verdicts are not kept: {error}", file=sys.stderr)


def _make_folder(folder: str) -> None:
    from pathlib import Path

    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unwritable(error, folder) from error


def _unwritable(error: OSError, folder: str) -> InputError:
    return InputError(
        f"{error.filename or folder}: cannot be written: {error.strerror}; give another folder with --save"
    )


def _save(rows: list[Reduced], meshes: Opened, folder: str, files: dict[int, str]) -> None:
    """Write the cases that were made smaller; `files` takes the file of each, by the place of the case."""
    from pathlib import Path

    from harness.compare.reproduction import save
    from harness.compare.script import script_of

    path_of = {opened.identity: path for path, opened in meshes.items()}
    for place, row in enumerate(rows):
        if row.small is not None:
            paths = [path_of[mesh.identity] for mesh in row.small.scene.meshes]
            path = save(row.small, Path(folder), f"{row.name}-{place}", paths, script_of(row.small))
            files[place] = str(path)


def _save_atlases(atlases: list[Surveyed], rows: list[Reduced], files: dict[int, str], folder: str) -> None:
    """Of several atlases each in a folder of its own, named as their experiments are."""
    from pathlib import Path

    from harness.cli.atlas_files import save_atlas

    file_of = {id(rows[place]): Path(file) for place, file in files.items()}
    for found in atlases:
        into = Path(folder) / found.experiment.name if len(atlases) > 1 else Path(folder)
        shown = {case: file_of[id(row)] for case, row in enumerate(found.rows) if id(row) in file_of}
        save_atlas(found, shown, into)


def _print(found: Comparison) -> None:
    from harness.vocabulary import MethodName

    kinds = ("agree", "undecided", "containment", "approximation", "real")
    for tally in found.tallies:
        counts = ", ".join(f"{kind} {getattr(tally, kind)}" for kind in kinds)
        if not MethodName.read(tally.backends[1], tally.shape).stepped:
            say(
                f"{tally.backends[1]}, {tally.shape}: {tally.verdicts} contacts that begin within {tally.poses} frames "
                f"while bodies approach, without response, each held against exact arithmetic: agree {tally.agree}, "
                f"undecided {tally.undecided}, real {tally.real}"
            )
            continue
        say(
            f"{' and '.join(tally.backends)}, {_asked(tally)}{tally.shape}: {tally.verdicts} verdicts "
            f"{'in' if tally.query == 'impact' else 'at'} {tally.poses} "
            f"{'frames' if tally.query == 'impact' else 'poses'}: {counts}"
        )
    for checked in found.checked:
        say(
            f"{' and '.join(checked.backends)}, {_asked(checked)}{checked.shape}: of what they agree on, "
            f"{checked.verdicts} verdicts were judged: {checked.contradicted} wrong"
        )
    for one in found.approximations:
        say(
            f"{one.backend} for {one.shape}, as bodies fly: {one.false_share:.3g} of its hits are none "
            f"({one.false_hits} of {one.reported}), {one.missed_share:.3g} of the touching pairs are missed "
            f"({one.misses} of {one.touching})"
        )
    for flight in found.free_runs:
        rates = "; ".join(
            f"{one.backend} {one.pair_hits_per_second:.4g} pair hits a second, energy {one.energy_change:+.2g}"
            for one in flight.afterwards
        )
        parted = (
            "they never diverge"
            if flight.diverged is None
            else f"they diverge at {flight.diverged:.6g} s; from then on"
        )
        say(f"{' and '.join(flight.backends)} in flight: {parted}: {rates}")
    for line in found.unsupported:
        say(line)
    for line in found.left_out:
        say(f"left out: {line}")
    for case in found.cases + found.shared:
        say(_sentence(case))
    for failure in found.failures:
        say(failure.sentence)


def _asked(counts: Counts) -> str:
    """What was asked, of queries other than collision."""
    return "" if counts.query == "collision" else f"{counts.query}, "


def _sentence(case: Case) -> str:
    truth, asked = case.judgement, case.question
    verb = "are both" if case.both_wrong else "is"
    about = "" if asked.query == "collision" else f" about {asked.text} ({case.error})"
    i, j = case.bodies
    touching = f"overlap by {-truth.gap:.3g} m" if truth.gap else "touch"  # of a gap no depth is told
    state = touching if truth.touching else f"are {truth.gap:.3g} m apart"
    return (
        f"{case.wrong} {verb} wrong{about}: at {case.pose.name} (call {case.query_index}) bodies {i} and {j} {state}"
        f"{_told(case)}, proven by {_article(truth.certificate['kind'])}"
    )


def _told(case: Case) -> str:
    """What was said instead, of queries other than collision."""
    from math import isinf

    query, told = case.question.query, case.told
    if query == "collision" or told is None:
        return ""
    when = f" {case.moment:.9g} s after its start" if query == "impact" else ""
    if isinf(told):
        return f"{when}, and it does not report them"
    if query == "impact":
        return f"{when}, and it says that they begin to touch at {told:.9g} s"
    return ", and it says that they are near" if query == "tolerance" else f", and it says {told:.9g} m"


def _article(kind: str) -> str:
    return kind if kind.startswith("nearest") else f"a {kind}"
