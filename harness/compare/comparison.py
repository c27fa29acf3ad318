"""Methods at the same poses: where their verdicts differ, whose is wrong, and whether that has an explanation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from itertools import combinations

from harness.compare.audit import audit_of
from harness.compare.budget import Budget
from harness.compare.group import Group, load
from harness.compare.isolated import ANSWER_SECONDS, preload
from harness.compare.outcome import LOADING, POINTS, Case, Comparison, Failure
from harness.compare.poses import Pose, PoseSet
from harness.compare.query_answers import PairAnswers, make_ready
from harness.compare.question import COLLISION, Question
from harness.compare.steadiness import unsteady
from harness.compare.tally import NamePair, Tally
from harness.compare.truths import Truths
from harness.scene.scene import Scene
from harness.vocabulary import MethodName

MOST_FAILURES = 5
"""A backend that has crashed or hung so often at the poses of one scene is not asked about the rest of them."""

Found = dict[NamePair, Comparison]


def compare(
    pose_sets: Iterable[PoseSet],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda line: None,
    timeout: float = ANSWER_SECONDS,
    budget: Budget | None = None,
) -> Comparison:
    """Hold every two of some methods against each other, as `compare_all`, and add up what was found."""
    whole = Comparison()
    for found in compare_all(pose_sets, names, progress, timeout, budget).values():
        whole.add(found)
    return whole


def compare_all(
    pose_sets: Iterable[PoseSet],
    names: Sequence[str],
    progress: Callable[[str], None] = lambda line: None,
    timeout: float = ANSWER_SECONDS,
    budget: Budget | None = None,
) -> Found:
    """Hold every two of some methods against each other; each is asked once a pose, and once more in another order.

    Parameters
    ----------
    pose_sets : the scenes and the poses to ask about
    names : of two methods at least
    progress : told what is being done
    timeout : s for an answer at one pose
    budget : ends it early, and keeps what was left out
    """
    budget = budget or Budget()
    for name in names:
        preload(name)
    whole: Found = {pair: Comparison() for pair in combinations(names, 2)}
    for pose_set in pose_sets:
        scene = pose_set.scene
        what = _what(pose_set)
        if budget.spent:
            budget.leave_out(what, _sizes(scene), f"not asked, {budget.why}")
            continue
        with budget.paused():
            for name in names:
                make_ready(MethodName.read(name, scene.shape, pose_set.question.query))
        progress(f"{', '.join(names)}: {what}")
        compared, hanging = _compare_at(pose_set, names, timeout, budget)
        for pair, found in compared.items():
            whole[pair].add(found)
        names = [name for name in names if name not in hanging]
        if len(names) < 2:
            break
    return whole


class Asked:
    """Two backends, loaded once with a scene and asked at any poses of it. A context: leaving it ends their processes.

    Parameters
    ----------
    scene : whose sizes and mesh the backends are loaded with
    names : of both
    question : what they are asked
    """

    def __init__(self, scene: Scene, names: NamePair, question: Question = COLLISION) -> None:
        self._scene, self.names, self._question = scene, names, question
        self._processes = ExitStack()

    def __enter__(self) -> Asked:
        with ExitStack() as processes:
            self._loaded = load(self._scene, self.names, processes, ANSWER_SECONDS, self._question)
            self._processes = processes.pop_all()
        return self

    def __exit__(self, *ending: object) -> None:
        self._processes.close()

    def disagreements(self, pose: Pose) -> list[Case]:
        """The real disagreements at a pose, and the errors that both share, each asked once."""
        pose_set = PoseSet(self._scene, lambda held: (pose,), hard=True, question=self._question)
        found = Comparison()
        for group in self._loaded.groups:
            for one in _Questions(pose_set, group, Budget(), again=False).ask().values():
                found.add(one)
        return found.cases + found.shared


def disagreements(scene: Scene, pose: Pose, names: NamePair, question: Question = COLLISION) -> list[Case]:
    """The real disagreements of two backends at one pose, and the errors that they share, each asked once, afresh."""
    with Asked(scene, names, question) as asked:
        return asked.disagreements(pose)


def _compare_at(
    pose_set: PoseSet, names: Sequence[str], timeout: float, budget: Budget
) -> tuple[Found, frozenset[str]]:
    """What was found at these poses, and who hung and is not to be asked about others."""
    shape, question = pose_set.scene.shape, pose_set.question
    whole: Found = {pair: Comparison([Tally(pair, shape, query=question.query)]) for pair in combinations(names, 2)}
    with ExitStack() as processes:
        loaded = load(pose_set.scene, names, processes, timeout, question)
        compared = {pair for group in loaded.groups for pair in group.pairs}
        for pair, found in whole.items():
            for name in [name for name in pair if name in loaded.unusable and pair not in compared][:1]:
                asked = "" if question.query == "collision" else f" asked {question.query}"
                line = f"{' and '.join(pair)} are not comparable on shape {shape}{asked}"
                found.unsupported.append(f"{line}: {name}: {loaded.unusable[name]}")
        for name in sorted(loaded.broken):
            pair = next(pair for pair in whole if name in pair)
            whole[pair].failures.append(Failure(pair, name, LOADING, 0, loaded.unusable[name]))
        for name, claim in loaded.claims.items():
            pair = next(pair for pair in whole if name in pair)
            whole[pair].failures.append(Failure(pair, name, LOADING, 0, claim, kind="claim"))
        left: dict[str, dict[str, None]] = {}
        for group in loaded.groups:
            questions = _Questions(pose_set, group, budget, again=True)
            for pair, found in questions.ask().items():
                whole[pair].add(found)
            if questions.left:
                left.setdefault(questions.left, {}).update(dict.fromkeys(questions.names))
        if left:
            said = "; ".join(f"{poses} of {', '.join(of)}" for poses, of in left.items())
            budget.leave_out(_what(pose_set), _sizes(pose_set.scene), f"not asked about {said}, {budget.why}")
        answering = [asked for group in loaded.groups for asked in group.asked.values()]
        silent = {asked.name for asked in answering if asked.timeouts >= MOST_FAILURES}
        for name in sorted(silent):
            pair = next(pair for pair in whole if name in pair)
            whole[pair].unsupported.append(
                f"{name} did not answer within {timeout:g} s at {MOST_FAILURES} poses of a scene, and is not asked "
                "about other scenes"
            )
    return whole, loaded.hanging.union(silent)


class _Questions:
    """A group of methods asked at the poses of one scene.

    Attributes
    ----------
    names : of the methods
    left : how many poses were not asked about, since the time was spent; empty if all were
    """

    left = ""

    def __init__(self, pose_set: PoseSet, group: Group, budget: Budget, *, again: bool) -> None:
        self._group, self._budget, self._again = group, budget, again
        self._poses = tuple(pose_set.poses(group.scene))
        facts = {name: asked.facts for name, asked in group.asked.items()}
        self._audits = {
            (one, other): audit_of(
                (one, other), group.scene, (facts[one], facts[other]), pose_set.question, flown=not pose_set.hard
            )
            for one, other in group.pairs
        }
        # in their order, those that some pair needs
        self.names = [name for name in group.asked if any(name in pair for pair in group.pairs)]
        self._answers: dict[str, dict[int, PairAnswers]] = {name: {} for name in self.names}
        self._failures: dict[str, list[Failure]] = {name: [] for name in self.names}
        self._exhausted: dict[str, str] = {}

    def ask(self) -> Found:
        """Every pose, every method."""
        for place in range(0, len(self._poses), self._budget.every):
            if self._budget.spent or not self._still_asked():
                break
            self._ask_at(place)
        else:
            place = len(self._poses)
        if self._budget.spent and place < len(self._poses):
            self.left = f"{len(self._poses) - place} of {len(self._poses)} poses"
        if self._again:
            self._ask_again()
        return self._found()

    def _still_asked(self) -> list[NamePair]:
        return [pair for pair in self._audits if not set(pair) & set(self._exhausted)]

    def _ask_at(self, place: int) -> None:
        pose, pairs = self._poses[place], self._still_asked()
        truths = Truths(self._group.scene, pose)
        for name in self.names:
            if not any(name in pair for pair in pairs):
                continue
            answer = self._group.asked[name].answers_at(pose)
            if isinstance(answer, str):
                self._failures[name].append(Failure(self._pair_of(name), name, pose.name, place + 1, answer))
                if sum(one.kind != POINTS for one in self._failures[name]) >= MOST_FAILURES:
                    self._exhausted[name] = (
                        f"{name} failed at {MOST_FAILURES} poses; from {pose.name} on it is not asked"
                    )
            else:
                self._answers[name][place] = answer
                self._note_points(name, pose, place)
        for pair in pairs:
            answers = [self._answers[name].get(place) for name in pair]
            if answers[0] is not None and answers[1] is not None:
                self._audits[pair].add(truths, place + 1, (answers[0], answers[1]))

    def _note_points(self, name: str, pose: Pose, place: int) -> None:
        """Keep that nearest points are none, a few times: more show the same."""
        found, failures = self._group.asked[name].misplaced, self._failures[name]
        if found is not None and sum(one.kind == POINTS for one in failures) < MOST_FAILURES:
            bodies, reason = found
            failures.append(Failure(self._pair_of(name), name, pose.name, place + 1, reason, POINTS, bodies))

    def _ask_again(self) -> None:
        for name in self.names:
            for one in unsteady(
                self._group.asked[name], name, self._group.scene, self._poses, self._answers[name], self._budget
            ):
                failure = Failure(
                    self._pair_of(name),
                    name,
                    one.pose,
                    one.query_index,
                    one.reason,
                    kind="random" if one.random else "depends on order",
                    bodies=one.bodies,
                )
                self._failures[name].append(failure)

    def _pair_of(self, name: str) -> NamePair:
        """The pair under which a failure of a method is kept: one, that it be told once."""
        return next(pair for pair in self._audits if name in pair)

    def _found(self) -> Found:
        found = {pair: audit.found for pair, audit in self._audits.items()}
        for name, failures in self._failures.items():
            found[self._pair_of(name)].failures += failures
        for name, line in self._exhausted.items():
            for pair in self._audits:
                if name in pair:
                    found[pair].unsupported.append(line)
        return found


def _what(pose_set: PoseSet) -> str:
    """What is asked at these poses, as a line begins; of collision the query is left out."""
    question, scene = pose_set.question, pose_set.scene
    asked = "" if question.query == "collision" else f"{question.text}, "
    return f"{asked}{len(scene.bodies)} bodies, shape {scene.shape}"


def _sizes(scene: Scene) -> str:
    sizes = scene.bodies.sizes
    return f"sizes {sizes.min():g} to {sizes.max():g} m" if len(sizes) and sizes.min() != sizes.max() else ""
