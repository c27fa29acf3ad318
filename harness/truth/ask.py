"""Asks of the cases of a set when bodies begin to touch, in a child process that a library may crash or hang."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from harness.arrays import Ints
from harness.backends.statement import missing
from harness.child_process import Channel, Child, guarded
from harness.truth.answerers import Answer, AskedEngine, answerer
from harness.truth.case_scene import CaseScenes
from harness.truth.folder import TruthSet
from harness.truth.verdict import Verdicts

_TOLD_EVERY = 500  # cases, after which a line of progress is told


def chosen(given: TruthSet, families: list[str], every: int) -> Ints:
    """(k,) numbers of cases: every n-th of each family, of some of the families, or of all."""
    wanted = families or list(dict.fromkeys(given.cases.families.tolist()))
    rows = [np.flatnonzero(given.cases.families == family)[::every] for family in wanted]
    return np.concatenate(rows).astype(np.int64)


def ask(
    given: TruthSet, engine: AskedEngine, rows: Ints, within: float, timeout: float, progress: Callable[[str], None]
) -> Verdicts:
    """Ask about some cases.

    Parameters
    ----------
    given : TruthSet
    engine : AskedEngine
    rows : (k,) int array, which cases
    within : s, by which a time may be out of its bounds whatever the tolerance is
    timeout : s that a case may take, before the process is ended and the case counted as failed
    progress : told a line now and then
    """
    scenes = CaseScenes(given)
    verdicts = Verdicts(given.cases, scenes, within)
    if engine.backend and (why := missing(engine.backend)) is not None:
        progress(f"{engine.label}: {why}")
        verdicts.problem = why
        return verdicts
    ordered = sorted(rows.tolist(), key=scenes.kind)
    for done, (row, answer) in enumerate(_answers(engine, scenes, ordered, timeout), 1):
        verdicts.add(row, answer)
        if isinstance(answer, str) and verdicts.failures[answer] == 1:
            progress(f"{engine.label}: cases.csv:{given.lines[row]}: {answer}")
        if done % _TOLD_EVERY == 0 or done == len(ordered):
            progress(f"{engine.label}: {done} of {len(ordered)} cases")
    return verdicts


def _answers(
    engine: AskedEngine, scenes: CaseScenes, rows: list[int], timeout: float
) -> Iterator[tuple[int, Answer | str | None]]:
    """Each case with what was told of it, or why nothing was; a process that fails is started anew behind its case."""
    place = 0
    while place < len(rows):
        with Child.fork(guarded(partial(_serve, engine, scenes, rows[place:]))) as child:
            while place < len(rows):
                message = child.receive(timeout)
                row, place = rows[place], place + 1
                if isinstance(message, bytes):
                    yield row, pickle.loads(message)
                    continue
                why = f"no answer within {timeout:g} s" if message == "timeout" else child.end().instead_of("an answer")
                yield row, why
                break


def _serve(engine: AskedEngine, scenes: CaseScenes, rows: list[int], channel: Channel) -> None:
    asked = answerer(engine, scenes)
    for row in rows:
        answer: Answer | str | None
        try:
            answer = asked.answer(row)
        except Exception as error:  # a library may fail in any way
            answer = f"{type(error).__name__}: {error}"
        channel.send(pickle.dumps(answer))
