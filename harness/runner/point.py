"""From a point of an experiment to what flies it: its method, and the law of its motion."""

from __future__ import annotations

from harness.experiment.experiment import Point
from harness.methods.method import Method
from harness.methods.registry import method_of
from harness.methods.stages import Plan
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import ALGORITHMS, MethodName


def name_of(point: Point) -> MethodName:
    """The name of the method of a point."""
    return MethodName(point.engine.backend, point.engine.algorithm, point.scene.shape, point.engine.query)


def method_of_point(point: Point) -> Method:
    """The method of a point, set as its engine says."""
    engine = point.engine
    return method_of(
        name_of(point),
        tolerance=engine.tolerance,
        within=engine.within,
        forced=engine.stages,
        threads=engine.threads,
    )


def law_of(point: Point, scene: Scene) -> MotionLaw:
    """How the bodies of a point move, whose scene is at hand."""
    motion = point.motion
    if scene.poses is not None:
        times = tuple(scene.poses.time.tolist())
        return MotionLaw(times[-1], times[-1] / (len(times) - 1), motion.response, times=times)
    return MotionLaw(motion.duration, motion.dt, motion.response, motion.restitution)


def plan_of(point: Point, scene: Scene) -> Plan:
    """The plan of a point, whose scene is at hand: the very object that a run of it loads.

    Raises
    ------
    InputError
        If the point forces a stage that cannot be forced, or its backend is missing.
    """
    return method_of_point(point).plan(scene, law_of(point, scene))


def is_stepped(point: Point) -> bool:
    """Whether the point looks at frames."""
    return ALGORITHMS[point.engine.algorithm].stepped
