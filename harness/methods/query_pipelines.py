"""Runs that ask more than whether pairs touch: frame after frame, in a motion that no answer changes.

Bodies pass through each other and only the box reflects them, so that a frame is its poses and the answer to them, or
what happens on the way from the last frame to it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.measure.clocks import Clock
from harness.methods.impact_times import FrameMotion, ImpactFinder, half_moves
from harness.methods.near_pairs import NearFinder
from harness.methods.observer import Folds, Observer, OnsetFinder, conserved
from harness.methods.stages import Plan
from harness.methods.step_metrics import PHASES, clock_metrics, rates
from harness.motion.answers import NearLog
from harness.motion.finite import require_finite_state
from harness.motion.hit_states import HitStateLog
from harness.motion.hits import Outcome
from harness.motion.kinematics import Trajectory
from harness.motion.law import MotionLaw
from harness.motion.recorded_motion import passing_course, trajectory_of
from harness.scene.scene import Scene
from harness.vocabulary import Query


@dataclass
class _Flight:
    """What a flight moves and is observed by.

    Attributes
    ----------
    observed : whether what the frames answer is looked at
    near : pairs that were near, over all frames asked about
    log : of the answers of every frame, if they are kept
    states : of the bodies of every event, if they are kept
    """

    law: MotionLaw
    trajectory: Trajectory
    clock: Clock
    observer: Observer
    folds: Folds
    onsets: OnsetFinder
    observed: bool
    near: int = 0
    log: NearLog | None = None
    states: HitStateLog | None = None

    def observe(self, time: float, pairs: Pairs, begun: Flags, times: Floats | None = None) -> None:
        """Observe a frame and keep the states of the bodies of its events, outside of the clock.

        Parameters
        ----------
        time, pairs : of the frame, as of `Observer.frame`
        begun : (k,) bool array, which of the pairs are events
        times : (k,) s, when the pairs began to touch, ascending; without, all at the frame
        """
        walls = self.folds.by(time)
        self.observer.frame(time, pairs, begun, walls, times)
        if self.states is None:
            return
        events = pairs[begun]
        if times is None:
            self._keep(time, events, walls)
            return
        for moment, pair in zip(times[begun].tolist(), events, strict=True):
            self._keep(moment, pair[None], _NO_WALLS)
        self._keep(time, _NO_PAIRS, walls)

    def _keep(self, time: float, pairs: Pairs, walls: Ints) -> None:
        if self.states is not None and (len(pairs) or walls.any()):
            self.trajectory.move_to(time)
            velocities = self.trajectory.velocities_at(time)
            self.states.add_passing(pairs, walls, self.trajectory.positions, velocities)


class QueryPipeline(ABC):
    """The plan of a run with a query, assembled: frames at k dt, k = 1 … frames.

    Parameters
    ----------
    scene : Scene
    plan : Plan of this scene
    """

    def __init__(self, scene: Scene, plan: Plan) -> None:
        self._scene, self._plan = scene, plan

    @abstractmethod
    def begin(self, flight: _Flight) -> None:
        """Get ready for a flight."""

    @abstractmethod
    def frame(self, flight: _Flight, number: int) -> None:
        """Ask a frame, within the clock, and observe what it answers, outside of it."""

    @property
    @abstractmethod
    def _query(self) -> Query:
        """What is asked."""

    @property
    @abstractmethod
    def counters(self) -> Mapping[str, float]:
        """What was counted over all frames that were asked."""

    @abstractmethod
    def found(self, flight: _Flight, times: float) -> dict[str, float]:
        """What was found over all frames, each of those asked standing for so many."""

    def fly(self, law: MotionLaw, *, traced: bool = False, observed: bool = True) -> Outcome:
        """Fly the scene once, from its start; documented as `harness.methods.method.Pipeline.fly`."""
        scene, plan = self._scene, self._plan
        trajectory = trajectory_of(scene, folded=True, turning=plan.keeps("orientations"))
        observer = Observer(scene, trajectory, penetration=False, traced=traced)
        flight = _Flight(
            law,
            trajectory,
            Clock(*PHASES),
            observer,
            Folds(trajectory),
            OnsetFinder(len(scene.bodies)),
            observed,
            log=self._log(traced),
            states=HitStateLog(scene.bodies.masses) if traced and plan.keeps("recording") else None,
        )
        self.begin(flight)
        # bodies at rest give the same answer in every frame, which is asked for once
        asked = law.frames if plan.keeps("motion") else min(1, law.frames)
        times = law.frames / asked if asked else 0.0
        for number in range(1, asked + 1):
            self.frame(flight, number)
        end = law.time_of(law.frames)
        require_finite_state(trajectory.positions, trajectory.velocities, end)
        clocks = clock_metrics(flight.clock, law.frames, end)
        if not observed:
            return Outcome(clocks, None)
        counted: dict[str, float] = {
            "frames": law.frames,
            **{name: times * count for name, count in self.counters.items()},
            "box_tests": 0,
            "box_hits": observer.wall_hits,
            **self.found(flight, times),
        }
        metrics = {
            **counted,
            **rates(counted, len(scene.bodies), law.frames, end),
            **clocks,
            **({} if scene.poses is not None else conserved(observer)),
            "event_digest": observer.digest.value,
        }
        states = None if flight.states is None else flight.states.states()
        trace = flight.observer.trace(end, counted, states=states, near=flight.log is not None)
        answers = flight.log.answers() if flight.log is not None else None
        if trace is not None:
            trace = replace(trace, query=self._query, answers=answers, step=law.dt)
        course = passing_course(scene, end) if plan.keeps("recording") else None
        return Outcome(metrics, trace, course, answers)

    def _walls_alone(self, flight: _Flight, time: float) -> None:
        """End a frame of bodies none of which can get near another."""
        flight.clock.lap("pair_seconds")
        if flight.observed:
            flight.observe(time, _NO_PAIRS, _NO_FLAGS)

    def _log(self, traced: bool) -> NearLog | None:
        return None


class NearPipeline(QueryPipeline):
    """Asks which pairs are near in every frame, and how far apart they are.

    Parameters
    ----------
    scene, plan : as for `QueryPipeline`
    finder : loaded with the scene; None where the plan leaves pairs out
    gaps : whether it is asked how far apart they are; else what a finder may say of it has no meaning
    """

    def __init__(self, scene: Scene, plan: Plan, finder: NearFinder | None, *, gaps: bool) -> None:
        super().__init__(scene, plan)
        self._finder, self._gaps = finder, gaps

    @property
    def _query(self) -> Query:
        return "distance" if self._gaps else "tolerance"

    @property
    def counters(self) -> Mapping[str, float]:
        return _NOTHING if self._finder is None else self._finder.counters

    def begin(self, flight: _Flight) -> None:
        """There is nothing to get ready."""

    def frame(self, flight: _Flight, number: int) -> None:
        time, trajectory, finder = flight.law.time_of(number), flight.trajectory, self._finder
        flight.clock.start()
        trajectory.move_to(time)
        if finder is None:
            self._walls_alone(flight, time)
            return
        found = finder.near(trajectory.positions, trajectory.quaternions)
        flight.clock.lap("pair_seconds")
        if not flight.observed:
            return
        pairs, gaps, points = finder.checked(found)
        flight.near += len(pairs)
        if flight.log is not None:
            # two points that are near show that the pair is, also where no gap was asked for
            flight.log.add(number, pairs, gaps if self._gaps else None, points)
        flight.observe(time, pairs, flight.onsets.of(pairs))

    def found(self, flight: _Flight, times: float) -> dict[str, float]:
        return {"near_pairs": times * flight.near, "events": flight.observer.wall_hits}

    def _log(self, traced: bool) -> NearLog | None:
        return NearLog() if traced else None


class ImpactPipeline(QueryPipeline):
    """Asks which pairs begin to touch between one frame and the next, and when.

    Parameters
    ----------
    scene, plan : as for `QueryPipeline`
    finder : loaded with the scene; None where the plan leaves pairs out
    """

    def __init__(self, scene: Scene, plan: Plan, finder: ImpactFinder | None) -> None:
        super().__init__(scene, plan)
        self._finder = finder
        self._middle = trajectory_of(scene, folded=True, turning=False)

    @property
    def _query(self) -> Query:
        return "impact"

    @property
    def counters(self) -> Mapping[str, float]:
        return _NOTHING if self._finder is None else self._finder.counters

    def begin(self, flight: _Flight) -> None:
        if self._finder is not None:
            self._finder.begin(half_moves(self._scene, self._scene.bodies.velocities, flight.law.dt))

    def frame(self, flight: _Flight, number: int) -> None:
        law = flight.law
        time, start = law.time_of(number), law.time_of(number - 1)
        dt = law.dt if law.times is None else time - start
        trajectory, finder = flight.trajectory, self._finder
        flight.clock.start()
        trajectory.move_to(start)
        if finder is None:
            self._walls_alone(flight, time)
            return
        self._middle.move_to(start + 0.5 * dt)
        motion = FrameMotion(
            trajectory.positions,
            trajectory.quaternions,
            self._middle.positions,
            trajectory.velocities_at(start),
            trajectory.spins_at(start),
            number == 1,
            dt,
        )
        found = finder.impacts(motion)
        flight.clock.lap("pair_seconds")
        if not flight.observed:
            return
        pairs, times = finder.checked(found)
        order = np.argsort(times, kind="stable")
        hits = np.ones(len(pairs), np.bool_)
        flight.observe(time, pairs[order], hits, start + times[order])

    def found(self, flight: _Flight, times: float) -> dict[str, float]:
        hits, walls = flight.observer.pair_hits, flight.observer.wall_hits
        return {"pair_hits": hits, "events": hits + walls}


_NOTHING: Mapping[str, float] = {"pair_tests": 0, "narrow_tests": 0}
_NO_PAIRS: Pairs = np.empty((0, 2), np.int64)
_NO_FLAGS: Flags = np.empty(0, np.bool_)
_NO_WALLS: Ints = np.zeros((0, 6), np.int64)
