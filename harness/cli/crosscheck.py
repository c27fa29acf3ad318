"""Experiments as poses to compare backends at, and what is kept of it; for `compare`, and for `sweep`.

`compare` asks about every frame and every hard pose. A sweep asks, of an experiment with `measure: {compare: on}`,
about as many frames of each scene as make 60 000 verdicts, and about every twenty-third first contact; scenes of which
two frames are more than that are left out. Of an experiment with several queries each is asked, of the methods that it
names for it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from statistics import fmean
from typing import Any

from harness.backends.registry import packages
from harness.backends.statement import missing
from harness.compare.budget import Budget
from harness.compare.comparison import Found, compare_all
from harness.compare.document import Known, Reduced, document, reduced, shown_case
from harness.compare.event_audit import audit_events
from harness.compare.free_running import digest_when_asked, run_both
from harness.compare.hard_questions import hard_questions
from harness.compare.outcome import Comparison
from harness.compare.poses import PoseSet, flown
from harness.compare.question import COLLISION, Question
from harness.errors import InputError
from harness.experiment.experiment import Experiment, Point
from harness.measure.machine import package_versions
from harness.runner.key import point_key
from harness.runner.point import law_of
from harness.runner.scene_of_point import SceneSizeError, build_scene
from harness.runner.servers import files_of
from harness.scene.launch import PlacementError
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.scene.scene_files import Opened
from harness.vocabulary import (
    EXACT_FRAMES,
    LIBRARY_IMPACTS,
    OWN_BACKEND,
    MethodName,
    PipelineName,
    Query,
    algorithms_of,
)

DEFAULT = (OWN_BACKEND, "pybullet")
"""What is compared where an experiment names fewer than two."""
DEFAULT_OF: Mapping[Query, tuple[str, str]] = {"impact": (OWN_BACKEND, LIBRARY_IMPACTS)}
"""Likewise, of a query that those cannot be asked."""

Asked = dict[Query, tuple[str, ...]]
"""By query, the methods that are asked it."""


@dataclass(frozen=True)
class Extent:
    """How much is asked.

    Parameters
    ----------
    verdicts : of a scene as it flies, about; None for every frame
    every : of the poses at first contact, ask about every n-th
    flown : frames of a free run, at the most; None for all
    """

    verdicts: int | None
    every: int
    flown: int | None

    def frames(self, frames: int, bodies: int) -> int | None:
        """The last frame of a scene to ask about, of all that it has; None to leave it out."""
        if self.verdicts is None:
            return frames
        most = self.verdicts // (bodies * (bodies - 1) // 2) - 1
        return min(frames, most) if most > 0 else None


WHOLE = Extent(verdicts=None, every=1, flown=None)
SWEPT = Extent(verdicts=60_000, every=23, flown=600)

# Cases of one backend that are made smaller, to be shown or to be saved: it takes a second or two each, and more of
# them show the same defect again.
SHOWN, SAVED = 2, 5


def backends_of(experiment: Experiment, chosen: tuple[str, ...] = ()) -> tuple[Asked, list[str]]:
    """Of each query the backends to compare: those chosen, else those the experiment names for it, else the default.

    Also what is missing.

    Raises
    ------
    InputError
        If one was chosen that is not installed or cannot be asked, or fewer than two are left.
    """
    methods = [MethodName.of(point.parameters) for point in experiment.points]
    asked, missing_ones = Asked(), dict[str, str]()
    for query in dict.fromkeys(method.query for method in methods):
        named = tuple(dict.fromkeys(one.short for one in methods if one.stepped and one.query == query))
        wanted = chosen or (named if len(named) > 1 else DEFAULT_OF.get(query, DEFAULT))
        lacking = {name: why for name in wanted if (why := missing(PipelineName.read(name).backend)) is not None}
        if chosen and lacking:
            raise InputError("\n".join(lacking.values()))
        _refuse_algorithms(chosen, query)
        left = tuple(name for name in wanted if name not in lacking and _stepped(name))
        events = event_methods(experiment, chosen) if query == "collision" else ()
        if len(left) + len(events) < 2:
            of_query = "" if query == "collision" else f" of query {query}"
            raise InputError(f"{experiment.path}: nothing to compare{of_query}; {'; '.join(lacking.values())}")
        asked[query] = left
        missing_ones |= lacking
    return asked, list(missing_ones.values())


def _refuse_algorithms(names: Sequence[str], query: Query) -> None:
    """Raises InputError for a method that some query can be put to, but not this one."""
    for name in names:
        backend, algorithm = PipelineName.read(name)
        if algorithm is not None and algorithm not in (possible := algorithms_of(backend, query)):
            raise InputError(
                f"--backends: {backend} cannot be asked query {query} with algorithm {algorithm}, only with "
                f"{', '.join(possible)}"
            )


def pairs_of(names: Asked, events: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Every two methods that are held against each other, of any query; last those that compute events."""
    found = [pair for asked in names.values() for pair in combinations(asked, 2)]
    return [*dict.fromkeys(found), *((EXACT_FRAMES, name) for name in events)]


def event_methods(experiment: Experiment, chosen: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The methods that compute events, of those chosen, or else of the experiment; without verdicts on poses."""
    named = dict.fromkeys(MethodName.of(point.parameters).short for point in experiment.points)
    return tuple(name for name in (chosen or named) if not _stepped(name))


def _stepped(name: str) -> bool:
    return MethodName.read(name, "hull").stepped  # which it is does not depend on the shape


def cross_check(
    experiment: Experiment,
    meshes: Opened,
    names: Asked,
    extent: Extent,
    progress: Callable[[str], None] = lambda line: None,
    budget: Budget | None = None,
    events: tuple[str, ...] = (),
) -> Iterator[tuple[tuple[str, str], Comparison]]:
    """Every two backends with what was found of them; each was asked once a pose for all of them.

    What computes events is held against the judge on the same motion, as `harness.compare.event_audit` says.
    """
    budget = budget or Budget()
    for name in events:
        progress(f"{name}: contacts of the same motion")
        yield (EXACT_FRAMES, name), _events(experiment, meshes, name, extent, budget)
    compared: Found = {}
    queries = [(query, asked) for query, asked in names.items() if len(asked) > 1]
    # what a question leaves of its share goes to those after it: that of touching surfaces takes longest to judge
    queries.sort(key=lambda named: named[0] == "collision")
    # what flies goes first, of every query, so that a budget leaves out what is hard of all rather than all of some
    for pose_sets_of in (_flown_sets, _hard_sets):
        for place, (query, asked) in enumerate(queries):
            with budget.share(len(queries) - place):
                pose_sets = pose_sets_of(experiment, meshes, extent, query)
                for pair, found in compare_all(pose_sets, asked, progress, budget=budget).items():
                    compared.setdefault(pair, Comparison()).add(found)
    for pair, found in compared.items():
        if set(pair) <= set(names.get("collision", ())):
            found.add(_free_runs(experiment, meshes, pair, extent, progress, budget))
        yield pair, found


def _free_runs(
    experiment: Experiment,
    meshes: Opened,
    pair: tuple[str, str],
    extent: Extent,
    progress: Callable[[str], None],
    budget: Budget,
) -> Comparison:
    """What is found of two backends in flight, in the first scene whose bodies answer hits; nothing without any."""
    free = next((point for point in experiment.points if point.motion.response != "none"), None)
    if free is None or (scene := _scene(experiment, free, meshes)) is None:
        return Comparison()
    in_flight = f"{' and '.join(pair)} in flight"
    if budget.spent:
        budget.leave_out(f"{in_flight}: not run, the time was spent")
        return Comparison()
    motion = free.motion
    frames = motion.frames if extent.flown is None else min(motion.frames, extent.flown)
    if budget.every > 1:
        frames = max(1, frames // budget.every)
        budget.leave_out(f"{in_flight}: no more than {frames} frames are flown")
    progress(f"{in_flight}: {len(scene.bodies)} bodies, {frames} frames")
    return run_both(scene, pair, frames=frames, dt=motion.dt, response=motion.response, restitution=motion.restitution)


def reductions(found: Comparison, meshes: Opened, most: int, known: Known | None = None) -> list[Reduced]:
    """The cases of a comparison, the first `most` of every backend made smaller, if that is not `known` already."""
    return reduced(found, {mesh.identity: path.name for path, mesh in meshes.items()}, most, known)


def kept(experiment: Experiment, found: Comparison, rows: list[Reduced]) -> dict[str, Any]:
    """What the database keeps of a comparison of two backends."""
    distinct = {row.text or str(place): row for place, row in enumerate(rows) if row.tried}
    return document(found, rows, {}) | {
        "title": experiment.title,
        "shown": [shown_case(row) for row in distinct.values()],
        "versions": package_versions(packages()),
    }


def key_of(
    experiment: Experiment, meshes: Opened, pair: tuple[str, str], extent: Extent, budget: Budget | None = None
) -> str:
    """Of two comparisons with the same key the second would find nothing new."""
    points = sorted({point_key(point, files_of(experiment, point, meshes)) for point in experiment.points})
    limits = [budget.seconds, budget.every] if budget and (budget.seconds or budget.every > 1) else []
    content = json.dumps([points, pair, repr(extent), package_versions(packages()), *limits])
    return hashlib.sha256(content.encode()).hexdigest()


def keys_of(experiment: Experiment, meshes: Opened) -> list[str]:
    """The keys of the points whose answers `timed_otherwise` holds against what is said here."""
    return [point_key(point, files_of(experiment, point, meshes)) for point in _asked_of_a_library(experiment)]


def timed_otherwise(
    experiment: Experiment, meshes: Opened, digests: Mapping[str, Collection[float]], budget: Budget
) -> Iterator[tuple[str, str]]:
    """Backends whose runs answered other hits than they answer when the same motion is put to them frame by frame.

    Parameters
    ----------
    digests : by the key of a point, the `event_digest` of its runs; one whose runs differ is known to be random
    budget : ends it early, and keeps what was left out

    Yields
    ------
    tuple of str
        A backend, and what is wrong, each once.
    """
    told: set[str] = set()
    for point in _asked_of_a_library(experiment):
        name = point.engine.backend
        answered = digests.get(point_key(point, files_of(experiment, point, meshes)), ())
        if name in told or len(answered) != 1 or (scene := _scene(experiment, point, meshes)) is None:
            continue
        digest = None if budget.spent else digest_when_asked(scene, name, law_of(point, scene), budget)
        if digest is None and budget.spent:
            budget.leave_out(f"{name}: its timed runs", how=f"not held against what it says here, {budget.why}")
        if digest is not None and digest not in answered:
            told.add(name)
            yield (
                name,
                "in its timed runs it answered other hits than it does when it is asked about the same frames in a "
                "process of its own",
            )


def _asked_of_a_library(experiment: Experiment) -> list[Point]:
    """The points that ask a library alone whether bodies touch."""
    points = [point for point in experiment.points if point.engine.query == "collision"]
    return [point for point in points if MethodName.of(point.parameters).short == point.engine.backend]


def _events(experiment: Experiment, meshes: Opened, name: str, extent: Extent, budget: Budget) -> Comparison:
    """A method that computes events, on every motion of the experiment."""
    whole = Comparison()
    points = [point for point in experiment.points if point.engine.query == "collision"]
    for point, scene, frames in _motions(experiment, meshes, extent, points, by_tolerance=True):
        if scene.poses is not None:
            raise InputError(f"{experiment.path}: {name} computes events, and poses are recorded; leave it out")
        dt, tolerance = point.motion.dt, point.engine.tolerance
        whole.add(audit_events(scene, name, max(1, frames // budget.every), dt, tolerance, budget))
    return whole


def _flown_sets(experiment: Experiment, meshes: Opened, extent: Extent, query: Query) -> Iterator[PoseSet]:
    """What the points of a query fly through, each scene once."""
    points = [point for point in experiment.points if point.engine.query == query]
    for point, scene, frames in _motions(experiment, meshes, extent, points, by_question=query != "collision"):
        yield flown(scene, frames, point.motion.dt, _question(point))


def _hard_sets(experiment: Experiment, meshes: Opened, extent: Extent, query: Query) -> Iterator[PoseSet]:
    """The hard poses of every shape of a mesh that the points of a query draw bodies of."""
    points = [point for point in experiment.points if point.engine.query == query and point.scene.bodies is None]
    random = {(point.scene.shape, point.scene.mesh_names, _question(point)): point for point in points}
    for (shape, _, question), point in random.items():
        size = point.scene.size
        for pair in _both(files_of(experiment, point, meshes).meshes):
            mean = fmean(mesh.diameter for mesh in pair) if size.is_native else size.mean
            yield from hard_questions(shape, pair, extent.every, question, size=mean)


def _both(meshes: tuple[Mesh, ...]) -> Iterator[tuple[Mesh, ...]]:
    """The meshes of two bodies: of each mesh with itself, and with the next one, so that every kind has its turn."""
    if not meshes:
        yield ()
    yield from ((mesh,) for mesh in meshes)
    yield from pairwise(meshes)


def _question(point: Point) -> Question:
    engine = point.engine
    if engine.query == "collision":
        return COLLISION
    return Question(engine.query, engine.within or 0.0, engine.tolerance)


def _motions(
    experiment: Experiment,
    meshes: Opened,
    extent: Extent,
    points: Sequence[Point],
    *,
    by_tolerance: bool = False,
    by_question: bool = False,
) -> Iterator[tuple[Point, Scene, int]]:
    """Each motion of some points that has a pair and frames to look at: a point of it, its scene, and how many.

    `by_tolerance` and `by_question` count a motion again that is asked about with another tolerance, or another
    question.
    """
    seen = set()
    for point in points:
        asked = (by_tolerance and point.engine.tolerance, by_question and _question(point))
        moved = repr((point.scene, point.motion.poses, point.motion.duration, point.motion.dt, *asked))
        if moved in seen:
            continue
        seen.add(moved)
        scene = _scene(experiment, point, meshes)
        frames = None if scene is None else extent.frames(law_of(point, scene).frames, len(scene.bodies))
        if scene is not None and frames is not None:
            yield point, scene, frames


def _scene(experiment: Experiment, point: Point, meshes: Opened) -> Scene | None:
    """The scene of a point; None where there is no pair."""
    try:
        scene = build_scene(point, files_of(experiment, point, meshes), experiment.measure.memory)
    except (PlacementError, SceneSizeError) as error:
        raise InputError(f"{experiment.path}: {error}") from error
    return scene if len(scene.bodies) > 1 else None
