"""Stepped motion: frame after frame, advance, find all touching pairs, answer them, then the walls.

Walls come last, so that no answer to a pair can send a centre out of the box. A frame is assembled from the steps that
the plan keeps; what it leaves out is not there to be asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.backends.contract import made, read_only, require_counters, require_pairs
from harness.backends.protocol import Backend
from harness.measure.clocks import Clock
from harness.methods.observer import Folds, Observer, OnsetFinder, conserved
from harness.methods.stages import Plan
from harness.methods.step_metrics import PHASES, clock_metrics, rates
from harness.motion.course import CourseLog
from harness.motion.finite import require_finite_state
from harness.motion.hit_states import HitStateLog, RecordedResponse
from harness.motion.hits import Outcome
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.motion.recorded_motion import passing_course, trajectory_of
from harness.motion.response import CollisionResponse
from harness.narrowphase.body_shapes import hulls_of_bodies
from harness.narrowphase.support import support_map
from harness.narrowphase.walls import hulls_at_walls, spheres_at_walls
from harness.scene.scene import Scene

_UNTIMED = ""
"""The clock of a step that no clock sees."""


@dataclass
class _Frame:
    """What the steps of a frame hand on.

    Attributes
    ----------
    time : s
    pairs : (k, 2) int array, touching
    hits : (k,) bool array, which of them were answered
    walls : (n, 6), which body was answered by which wall
    """

    time: float
    pairs: Pairs
    hits: Flags
    walls: Ints | Flags


# What is done in a frame, in order, each with the clock that it counts for.
_Step = tuple[str, Callable[[_Frame], None]]


class Detector(Protocol):
    """Finds all touching pairs of a scene at given poses; a loaded backend is one."""

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        """All touching pairs, (k, 2), i < j, sorted; positions (n, 3) in m, quaternions (n, 4) unit, w x y z."""


class Stepping:
    """The plan of a stepped run, assembled: frames at k dt, k = 1 … frames.

    Parameters
    ----------
    scene : Scene
    plan : Plan of this scene
    detector : loaded with the scene; None where the plan leaves pairs out
    """

    def __init__(self, scene: Scene, plan: Plan, detector: Detector | None) -> None:
        self._scene, self._plan, self._detector = scene, plan, detector

    def fly(self, law: MotionLaw, *, traced: bool = False, observed: bool = True) -> Outcome:
        """Fly the scene once, from its start: the counters, clocks and errors of a stepped run.

        Parameters
        ----------
        law : MotionLaw
        traced : keep every hit
        observed : without, clocks alone
        """
        scene, plan, detector = self._scene, self._plan, self._detector
        folded, recorded = law.response == "none", plan.keeps("recording")
        trajectory = trajectory_of(scene, folded=folded, turning=plan.keeps("orientations"))
        observer = Observer(scene, trajectory, penetration=observed and plan.keeps("penetration"), traced=traced)
        response, states = _response(scene, trajectory, law, stateful=traced and recorded)
        course = CourseLog(trajectory.positions, trajectory.velocities) if recorded and response else None
        steps = _steps(scene, plan, trajectory, detector, response)
        observe = _observation(observer, trajectory, response, course, states) if observed else _unobserved
        clock = Clock(*PHASES)

        def fly(number: int) -> _Frame:
            frame = _Frame(law.time_of(number), _NO_PAIRS, _NO_HITS, _NO_WALLS)
            clock.start()
            for phase, step in steps:
                step(frame)
                if phase == _UNTIMED:
                    clock.start()
                else:
                    clock.lap(phase)
            observe(frame)
            return frame

        if plan.keeps("motion"):
            tests = _every_frame(fly, law.frames, detector)
        else:
            tests = _first_frames(fly, law.frames, observer, detector)
        end = law.time_of(law.frames)
        require_finite_state(trajectory.positions, trajectory.velocities, end)
        clocks = clock_metrics(clock, law.frames, end)
        if not observed:
            return Outcome(clocks, None)
        counted: dict[str, float] = {
            **tests,
            "frames": law.frames,
            "box_tests": 6 * len(scene.bodies) * law.frames if plan.keeps("walls") else 0,
            "pair_hits": observer.pair_hits,
            "pair_contacts": observer.pair_contacts,
            "box_hits": observer.wall_hits,
            "events": observer.pair_hits + observer.wall_hits,
        }
        metrics = {
            **counted,
            **rates(counted, len(scene.bodies), law.frames, end),
            **clocks,
            **_errors(scene, observer, response, plan),
        }
        trace = observer.trace(end, counted, states=None if states is None else states.states())
        if course is not None:
            return Outcome(metrics, trace, course.course())
        return Outcome(metrics, trace, passing_course(scene, end) if recorded else None)


_NO_PAIRS: Pairs = np.empty((0, 2), np.int64)
_NO_HITS: Flags = np.empty(0, np.bool_)
_NO_WALLS: Flags = np.empty((0, 6), np.bool_)


def _response(
    scene: Scene, trajectory: Trajectory, law: MotionLaw, *, stateful: bool
) -> tuple[CollisionResponse | None, HitStateLog | None]:
    """What answers the contacts, if anything does, and the log of the states of its hits, if they are asked for."""
    masses = scene.bodies.masses
    if law.response == "none":
        return None, HitStateLog(masses) if stateful else None
    if not stateful:
        return CollisionResponse(masses, law.response, law.restitution), None
    response = RecordedResponse(masses, law.response, law.restitution, trajectory.positions)
    return response, response.log


def _steps(
    scene: Scene, plan: Plan, trajectory: Trajectory, detector: Detector | None, response: CollisionResponse | None
) -> list[_Step]:
    """The steps of a frame that the plan keeps."""

    def move(frame: _Frame) -> None:
        trajectory.move_to(frame.time)

    steps: list[_Step] = [("pair_seconds", move)]
    if detector is not None:
        detect = detector.pairs
        positions, quaternions = trajectory.positions, trajectory.quaternions

        # a backend may be anybody's; what is our own needs no such view, for which its kernels would be compiled anew
        def move_and_detect(frame: _Frame) -> None:
            trajectory.move_to(frame.time)
            frame.pairs = detect(positions, quaternions)

        steps = [("pair_seconds", move_and_detect)]
        if isinstance(detector, Backend):
            name, count = detector.name, len(scene.bodies)
            watched = read_only(positions), read_only(quaternions)

            def move_and_ask(frame: _Frame) -> None:
                trajectory.move_to(frame.time)
                frame.pairs = cast(Pairs, made(detect(*watched)))

            def check(frame: _Frame) -> None:
                frame.pairs = require_pairs(name, frame.pairs, count)

            steps = [("pair_seconds", move_and_ask), (_UNTIMED, check)]
    if response is None:
        return steps

    def respond(frame: _Frame) -> None:
        response.changed[:] = False
        frame.hits = response.pairs(frame.pairs, trajectory.positions, trajectory.velocities)

    def respond_and_redirect(frame: _Frame) -> None:
        respond(frame)
        trajectory.redirect(response.changed, frame.time)

    def walls_and_redirect(frame: _Frame) -> None:
        frame.walls = response.walls(touching_walls(trajectory), trajectory.velocities)
        trajectory.redirect(response.changed, frame.time)

    def walls_alone(frame: _Frame) -> None:
        response.changed[:] = False
        walls_and_redirect(frame)

    if not plan.keeps("walls"):
        return [*steps, ("response_seconds", respond_and_redirect)] if plan.keeps("response") else steps
    touching_walls = _wall_test(scene, plan)
    if not plan.keeps("response"):
        return [*steps, ("box_seconds", walls_alone)]
    return [*steps, ("response_seconds", respond), ("box_seconds", walls_and_redirect)]


def _unobserved(frame: _Frame) -> None:
    """Nothing is looked at."""


def _observation(
    observer: Observer,
    trajectory: Trajectory,
    response: CollisionResponse | None,
    course: CourseLog | None,
    states: HitStateLog | None,
) -> Callable[[_Frame], None]:
    """What observes a frame after it, outside of all clocks."""

    def answered(frame: _Frame) -> None:
        observer.frame(frame.time, frame.pairs, frame.hits, frame.walls)

    def passing(frame: _Frame) -> None:
        begun, walls = onsets.of(frame.pairs), folds.by(frame.time)
        observer.frame(frame.time, frame.pairs, begun, walls)
        if states is not None:
            states.add_passing(frame.pairs[begun], walls, trajectory.positions, trajectory.velocities_at(frame.time))

    if response is not None:
        return answered if course is None else _recorded(answered, course, trajectory)
    onsets, folds = OnsetFinder(len(trajectory.positions)), Folds(trajectory)
    return passing


def _recorded(observe: Callable[[_Frame], None], course: CourseLog, trajectory: Trajectory) -> Callable[[_Frame], None]:
    """The same, and the legs that begin in the frame are kept."""

    def observe_and_keep(frame: _Frame) -> None:
        observe(frame)
        course.turn(frame.time, trajectory.positions, trajectory.velocities)

    return observe_and_keep


def _every_frame(fly: Callable[[int], _Frame], frames: int, detector: Detector | None) -> dict[str, float]:
    """Fly all frames; the counters of the detector."""
    for number in range(1, frames + 1):
        fly(number)
    return _pair_counters(detector)


def _first_frames(
    fly: Callable[[int], _Frame], frames: int, observer: Observer, detector: Detector | None
) -> dict[str, float]:
    """Bodies at rest: frames until two in a row have asked for the same work, which stand for all that follow.

    Returns the counters of the detector as if every frame had been asked for.
    """
    before = _pair_counters(detector)
    last: dict[str, float] = {}
    for number in range(1, frames + 1):
        frame = fly(number)
        now = _pair_counters(detector)
        work = {name: now[name] - before.get(name, 0) for name in now}
        before = now
        if work == last:
            observer.repeat(frame.pairs, frames - number)
            return {name: now[name] + (frames - number) * work[name] for name in now}
        last = work
    return before


def _wall_test(scene: Scene, plan: Plan) -> Callable[[Trajectory], Flags]:
    """The test of all bodies against the six walls that the scene needs; its answer is overwritten by the next."""
    touching = np.zeros((len(scene.bodies), 6), np.bool_)
    half, sizes, radii = scene.box.half, scene.bodies.sizes, scene.bodies.radii
    if scene.shape == "sphere":

        def spheres(trajectory: Trajectory) -> Flags:
            spheres_at_walls(trajectory.positions, radii, half, touching)
            return touching

        return spheres
    maps = [support_map(mesh.hull.vertices) for mesh in scene.meshes]
    of_bodies, cull = hulls_of_bodies(maps, scene.mesh_of), plan.keeps("wall_cull")

    def hulls(trajectory: Trajectory) -> Flags:
        hulls_at_walls(trajectory.positions, trajectory.quaternions, sizes, of_bodies, half, cull, touching)
        return touching

    return hulls


def _pair_counters(detector: Detector | None) -> dict[str, float]:
    """`pair_tests`, `narrow_tests` and what else the detector has counted so far, if it counts."""
    if detector is None:
        return {"pair_tests": 0, "narrow_tests": 0}
    counters = getattr(detector, "counters", {})
    return require_counters(detector.name, counters) if isinstance(detector, Backend) else dict(counters)


def _errors(scene: Scene, observer: Observer, response: CollisionResponse | None, plan: Plan) -> dict[str, float]:
    errors = {} if scene.poses is not None else conserved(observer)
    errors["event_digest"] = observer.digest.value
    if response is not None and response.elastic and observer.conservation.momentum_scale > 0.0:
        errors["momentum_drift"] = response.momentum_added / observer.conservation.momentum_scale
    if plan.keeps("penetration"):
        errors["max_penetration"] = observer.max_penetration
    return errors
