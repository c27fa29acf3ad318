"""Two backends at the same poses: where their verdicts differ, whose is wrong, and whether it could be helped."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import combinations

from harness.arrays import Pairs
from harness.compare.bench import Bench
from harness.compare.isolated import PATIENCE, Isolated, UnusableError
from harness.compare.outcome import Case, Comparison, Failure
from harness.compare.poses import Pose, PoseSet
from harness.compare.tally import Tally
from harness.scene.scene import Scene

MOST_FAILURES = 5
"""A backend that has crashed or hung so often at the poses of one scene is not asked about the rest of them."""


def compare(
    settings: Iterable[PoseSet],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda line: None,
    patience: float = PATIENCE,
) -> Comparison:
    """Hold every two of some backends against each other.

    Parameters
    ----------
    settings : the scenes and the poses to ask about
    names : of two backends at least
    progress : told what is being done
    patience : s for an answer at one pose
    """
    found = Comparison()
    for setting in settings:
        for first, second in combinations(names, 2):
            shape = setting.scene.shape
            progress(f"{first} and {second}: {len(setting.scene.bodies)} bodies, shape {shape}")
            found.add(_compare_two(setting, (first, second), patience))
    return found


def disagreements(scene: Scene, pose: Pose, names: tuple[str, str]) -> list[Case]:
    """The real disagreements of two backends at one pose, and the errors that they share, each asked once, afresh."""
    found = _compare_two(PoseSet(scene, lambda held: (pose,), hard=True), names, PATIENCE)
    return found.cases + found.shared


def _compare_two(setting: PoseSet, names: tuple[str, str], patience: float) -> Comparison:
    with ExitStack() as processes:
        try:
            scene, asked = _loaded(setting.scene, names, processes, patience)
        except UnusableError as error:
            line = f"{names[0]} and {names[1]} are not comparable on shape {setting.scene.shape}: {error}"
            return Comparison([Tally(names, setting.scene.shape)], unsupported=[line])
        bench = Bench(names, scene, (asked[0].facts, asked[1].facts), flown=not setting.hard)
        failures: list[Failure] = []
        unsupported: list[str] = []
        for call, pose in enumerate(setting.poses(scene), 1):
            answers: list[Pairs] = []
            for name, backend in zip(names, asked, strict=True):
                answer = backend.pairs(pose)
                if isinstance(answer, str):
                    failures.append(Failure(names, name, pose.name, call, answer))
                else:
                    answers.append(answer)
            tired = [name for name in names if sum(f.backend == name for f in failures) >= MOST_FAILURES]
            if tired:
                unsupported.append(f"{tired[0]} failed at {MOST_FAILURES} poses; from {pose.name} on it is not asked")
                break
            if len(answers) == 2:
                bench.take(pose, call, answers)
    found = bench.found
    found.failures, found.unsupported = failures, unsupported
    return found


def _loaded(
    scene: Scene, names: tuple[str, str], processes: ExitStack, patience: float
) -> tuple[Scene, list[Isolated]]:
    """Both backends with the scene; where one of them holds hulls of its own, the other is given those."""
    asked = [_enter(name, scene, processes, patience) for name in names]
    holders = [place for place in (0, 1) if asked[place].facts.hulls]
    if len(holders) == 1:
        other = 1 - holders[0]
        scene = replace(scene, hulls=asked[holders[0]].facts.hulls)
        asked[other] = _enter(names[other], scene, processes, patience)
    return scene, asked


def _enter(name: str, scene: Scene, processes: ExitStack, patience: float) -> Isolated:
    try:
        return processes.enter_context(Isolated(name, scene, patience))
    except UnusableError as error:
        raise UnusableError(f"{name}: {error}") from None
