"""Two backends at the same poses: where their verdicts differ, whose is wrong, and whether that has an explanation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import combinations

from harness.arrays import Pairs
from harness.compare.isolated import ANSWER_SECONDS, Isolated, UnusableError
from harness.compare.outcome import Case, Comparison, Failure
from harness.compare.pair_audit import PairAudit
from harness.compare.poses import Pose, PoseSet
from harness.compare.tally import NamePair, Tally
from harness.scene.scene import Scene

MOST_FAILURES = 5
"""A backend that has crashed or hung so often at the poses of one scene is not asked about the rest of them."""


def compare(
    pose_sets: Iterable[PoseSet],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda line: None,
    timeout: float = ANSWER_SECONDS,
) -> Comparison:
    """Hold every two of some backends against each other.

    Parameters
    ----------
    pose_sets : the scenes and the poses to ask about
    names : of two backends at least
    progress : told what is being done
    timeout : s for an answer at one pose
    """
    found = Comparison()
    for pose_set in pose_sets:
        for first, second in combinations(names, 2):
            scene = pose_set.scene
            progress(f"{first} and {second}: {len(scene.bodies)} bodies, shape {scene.shape}")
            found.add(_compare_two(pose_set, (first, second), timeout))
    return found


def disagreements(scene: Scene, pose: Pose, names: NamePair) -> list[Case]:
    """The real disagreements of two backends at one pose, and the errors that they share, each asked once, afresh."""
    found = _compare_two(PoseSet(scene, lambda held: (pose,), hard=True), names, ANSWER_SECONDS)
    return found.cases + found.shared


def _compare_two(pose_set: PoseSet, names: NamePair, timeout: float) -> Comparison:
    with ExitStack() as processes:
        try:
            scene, asked = _loaded(pose_set.scene, names, processes, timeout)
        except UnusableError as error:
            line = f"{names[0]} and {names[1]} are not comparable on shape {pose_set.scene.shape}: {error}"
            return Comparison([Tally(names, pose_set.scene.shape)], unsupported=[line])
        audit = PairAudit(names, scene, (asked[0].facts, asked[1].facts), flown=not pose_set.hard)
        failures: list[Failure] = []
        unsupported: list[str] = []
        for query_index, pose in enumerate(pose_set.poses(scene), 1):
            answers: list[Pairs] = []
            for name, backend in zip(names, asked, strict=True):
                answer = backend.pairs(pose)
                if isinstance(answer, str):
                    failures.append(Failure(names, name, pose.name, query_index, answer))
                else:
                    answers.append(answer)
            exhausted = [name for name in names if sum(f.backend == name for f in failures) >= MOST_FAILURES]
            if exhausted:
                unsupported.append(
                    f"{exhausted[0]} failed at {MOST_FAILURES} poses; from {pose.name} on it is not asked"
                )
                break
            if len(answers) == 2:
                audit.add(pose, query_index, answers)
    found = audit.found
    found.failures, found.unsupported = failures, unsupported
    return found


def _loaded(scene: Scene, names: NamePair, processes: ExitStack, timeout: float) -> tuple[Scene, list[Isolated]]:
    """Both backends with the scene; where one of them holds hulls of its own, the other is given those."""
    asked = [_enter(name, scene, processes, timeout) for name in names]
    holders = [place for place in (0, 1) if asked[place].facts.hulls]
    if len(holders) == 1:
        other = 1 - holders[0]
        scene = replace(scene, hulls=asked[holders[0]].facts.hulls)
        asked[other] = _enter(names[other], scene, processes, timeout)
    return scene, asked


def _enter(name: str, scene: Scene, processes: ExitStack, timeout: float) -> Isolated:
    try:
        return processes.enter_context(Isolated(name, scene, timeout))
    except UnusableError as error:
        raise UnusableError(f"{name}: {error}") from None
