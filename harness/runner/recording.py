"""What a replay shows, put together from a scene and the flight that was recorded; and which points a sweep records."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from harness.experiment.experiment import Point
from harness.motion.answers import NearAnswers
from harness.motion.hits import Outcome
from harness.motion.law import MotionLaw
from harness.motion.reach import all_at_rest
from harness.runner.contact_points import contact_points
from harness.runner.point import is_stepped, law_of
from harness.scene.scene import Scene
from harness.store.recording import NearLines, RecordedMesh, Recording
from harness.store.records import RunRecord

# A sweep records a scene of at most this many bodies, hits and lines between near bodies, whose run took at most this
# long (s): all of an experiment's page together, and of a default sweep a few seconds.
MOST_BODIES = 500
MOST_LINES = 50_000
MOST_HITS = 5000
MOST_SECONDS = 1.0


def recording_of(point: Point, scene: Scene, outcome: Outcome) -> Recording:
    """The recording of a flight.

    Parameters
    ----------
    point : that was run
    scene : its scene, at time 0
    outcome : of the flight, with trace and course
    """
    trace, course, bodies = outcome.trace, outcome.course, scene.bodies
    assert trace is not None
    assert course is not None
    shown = () if scene.shape == "sphere" else scene.meshes
    return Recording(
        shape=scene.shape,
        duration=trace.time,
        dt=law_of(point, scene).dt if is_stepped(point) else None,
        half_box=scene.box.half if scene.poses is None else None,
        sizes=bodies.sizes,
        quaternions=bodies.quaternions,
        spins=bodies.spins,
        surfaces=tuple(RecordedMesh(mesh.name, mesh.digest, mesh.vertices, mesh.faces) for mesh in shown),
        surface_of=scene.mesh_of,
        leg_times=course.times,
        leg_bodies=course.bodies,
        leg_positions=course.positions,
        leg_velocities=course.velocities,
        hit_times=trace.times,
        hit_bodies=trace.bodies,
        hit_walls=trace.walls,
        near=_near_lines(outcome.answers, law_of(point, scene), scene) if outcome.answers is not None else None,
        hit_points=contact_points(scene, trace) if point.engine.query == "impact" else None,
        leg_quaternions=course.quaternions,
        leg_spins=course.spins,
    )


def _near_lines(answers: NearAnswers, law: MotionLaw, scene: Scene) -> NearLines:
    """The lines of all frames, between pairs that are apart and have points, which some libraries do not tell."""
    with np.errstate(invalid="ignore"):
        there = (np.linalg.norm(answers.points[:, 0] - answers.points[:, 1], axis=1) > 0.0) & (answers.gaps != 0.0)
    found = NearLines(answers.frames[there], answers.pairs[there], answers.points[there])
    if scene.poses is not None or not all_at_rest(scene) or found.frames.max(initial=1) > 1:
        return found
    # the one frame that was asked about stands for all
    frames = np.repeat(np.arange(1, law.frames + 1), len(found.frames))
    return NearLines(frames, np.tile(found.pairs, (law.frames, 1)), np.tile(found.points, (law.frames, 1, 1)))


def worth_recording(bodies: Mapping[str, int], runs: Iterable[RunRecord]) -> str | None:
    """The point of an experiment that its page should replay: of those that are small enough, the fullest scene.

    Parameters
    ----------
    bodies : how many each of its points has, in order, by key; of two equally full ones the first is chosen
    runs : of it; the conditions of a run do not matter, its time does

    Returns
    -------
    The key, or None where no run is small enough.

    Examples
    --------
    >>> metrics = {"events": 9, "run_seconds": 0.1}
    >>> runs = [RunRecord("e", point, 0, "ok", None, 0, True, {}, metrics) for point in ("few", "many")]
    >>> worth_recording({"few": 5, "many": 50}, runs)
    'many'
    """
    small_enough = {
        run.point for run in runs if run.status == "ok" and bodies[run.point] <= MOST_BODIES and _is_short(run.metrics)
    }
    return max((key for key in bodies if key in small_enough), key=lambda key: bodies[key], default=None)


def _is_short(metrics: Mapping[str, float]) -> bool:
    """Whether a run reports so little that a page can show it; what is not a number is not little."""
    most = {"events": MOST_HITS, "run_seconds": MOST_SECONDS}
    short = all(metrics.get(name, math.nan) <= limit for name, limit in most.items())
    return short and not metrics.get("near_pairs", 0.0) > MOST_LINES
