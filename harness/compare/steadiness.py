"""Whether a method's verdict depends on the pose alone: every pose is asked again, in another order, and one afresh.

Where the answer is another one, the pose is asked twice in a row and put to a new process as its first question: a
method whose answers differ even then is random, else its verdict depends on what was asked before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.compare.audit import changed_pair
from harness.compare.budget import Budget
from harness.compare.isolated import Isolated, UnusableError
from harness.compare.poses import Pose
from harness.compare.query_answers import PairAnswers
from harness.scene.scene import Scene

_SEED = 259
MOST_UNSTEADY = 3
"""A method is named for so many poses of a scene; more show the same."""


@dataclass(frozen=True)
class Unsteady:
    """A pose at which a method changed its verdict.

    Parameters
    ----------
    pose, query_index : where; the number of the question in the first order, from 1
    bodies : the first pair of which one answer tells another thing
    random : it changes even when asked twice in a row, or as the first question of a new process
    """

    pose: str
    query_index: int
    bodies: tuple[int, int]
    random: bool

    @property
    def reason(self) -> str:
        """In a sentence, without the name of the method."""
        how = "its verdict is random" if self.random else "its verdict depends on what was asked before"
        return f"{how}: on bodies {self.bodies[0]} and {self.bodies[1]} it changes when the same pose is asked again"


def unsteady(
    asked: Isolated, name: str, scene: Scene, poses: Sequence[Pose], answers: dict[int, PairAnswers], budget: Budget
) -> list[Unsteady]:
    """Ask every pose that was answered again. What is nearer than the method claims to know may change.

    Parameters
    ----------
    asked : the method as it was asked before, of this name, with this scene
    poses : in the order in which they were asked
    answers : by place in `poses`
    budget : ends it early
    """
    found: list[Unsteady] = []
    order = np.random.default_rng(_SEED).permutation(sorted(answers))
    for place in order.tolist():
        if budget.spent or len(found) >= MOST_UNSTEADY:
            break
        again = asked.answers_at(poses[place])
        if isinstance(again, str):
            continue  # the failure itself has been told, or will be
        differing = changed_pair(asked.question, asked.facts, scene, poses[place], answers[place], again)
        if differing is not None:
            random = _is_random(asked, name, scene, poses[place])
            found.append(Unsteady(poses[place].name, place + 1, differing, random))
    if not found and answers and not budget.spent:
        found += _changed_afresh(asked, name, scene, poses, answers)
    return sorted(found, key=lambda one: one.query_index)


def _changed_afresh(
    asked: Isolated, name: str, scene: Scene, poses: Sequence[Pose], answers: dict[int, PairAnswers]
) -> list[Unsteady]:
    """The pose that was asked last, with the most before it, is the first question of a new process."""
    place = max(answers)
    try:
        with Isolated(name, scene, question=asked.question) as fresh:
            answer = fresh.answers_at(poses[place])
    except UnusableError:
        return []
    if isinstance(answer, str):
        return []
    differing = changed_pair(asked.question, asked.facts, scene, poses[place], answers[place], answer)
    if differing is None:
        return []
    return [Unsteady(poses[place].name, place + 1, differing, _is_random(asked, name, scene, poses[place]))]


_TRIES = 8


def _is_random(asked: Isolated, name: str, scene: Scene, pose: Pose) -> bool:
    """Whether a pose that follows itself, or comes first, gets several answers."""
    asked.answers_at(pose)
    in_a_row = {_key(asked.answers_at(pose)) for _ in range(_TRIES)}
    if len(in_a_row) > 1:
        return True
    first = set()
    for _ in range(2):
        try:
            with Isolated(name, scene, question=asked.question) as fresh:
                first.add(_key(fresh.answers_at(pose)))
        except UnusableError:
            return False
    return len(first) > 1


def _key(answer: PairAnswers | str) -> tuple[tuple[tuple[int, int], float], ...] | str:
    return answer if isinstance(answer, str) else tuple(sorted(answer.items()))
