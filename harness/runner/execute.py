"""One run in this process: build the scene, plan it, fly it, and say what came out."""

from __future__ import annotations

import resource
import sys
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite

from harness.backends import registry
from harness.backends.contract import ContractError
from harness.cpu_time import charged
from harness.descendants import cpu_time_of_descendants
from harness.experiment.experiment import Point
from harness.measure.clocks import Clock
from harness.measure.metrics import from_outcome
from harness.measure.roofline import roofline
from harness.methods.method import Method
from harness.methods.stages import Plan
from harness.motion.finite import NotFiniteError
from harness.motion.hits import Trace
from harness.motion.law import MotionLaw
from harness.reference.invariance import invariance
from harness.runner import accuracy
from harness.runner.point import is_stepped, law_of, method_of_point
from harness.runner.recording import recording_of
from harness.runner.repetition import fly_long_enough, warm
from harness.runner.scene_of_point import build_scene
from harness.runner.warm_up import warm_up
from harness.scene.scene import Scene
from harness.scene.scene_files import SceneFiles
from harness.store.recording import Recording


@dataclass(frozen=True)
class Result:
    """What a run that came to its end has measured, and in how many flights of its scene."""

    metrics: dict[str, float]
    plan: Plan
    trace: Trace | None = None
    flights: int = 1
    recording: Recording | None = None


def execute(
    point: Point,
    files: SceneFiles,
    *,
    memory: int | None = None,
    traced: bool = False,
    recorded: bool = False,
    on_demand: Collection[str] = (),
) -> Result:
    """Run a point once, in this process.

    Parameters
    ----------
    point : Point
    files : that its scene names
    memory : B that the scene may need
    traced : keep every hit, with the state of its bodies
    recorded : keep what a replay shows, and measure nothing else: the clocks of such a run see it
    on_demand : metrics to measure that are measured on demand alone

    Raises
    ------
    PlacementError, SceneSizeError, InputError
        If the point cannot be run as it is declared.
    NotFiniteError
        If what it came to is not all numbers.
    """
    warm_up(point)
    clock = Clock("setup_seconds")
    scene, method = build_scene(point, files, memory), method_of_point(point)
    law = law_of(point, scene)
    plan = method.plan(scene, law, recorded=traced or recorded)
    pipeline = method.load(scene, plan)
    clock.lap("setup_seconds")
    if not (traced or recorded):
        # what it keeps from flight to flight must not be counted, so that another is loaded for the run
        warm(partial(pipeline.fly, observed=False), law)
        del pipeline
        pipeline = method.load(scene, plan)
    # what a stepped run watches is outside of its clocks; an event-driven one would keep its events within them
    watched = traced or recorded or (point.reference is not None and is_stepped(point))
    fly = partial(pipeline.fly, law, traced=watched)
    again = partial(pipeline.fly, law, observed=False)
    elsewhere = cpu_time_of_descendants() - charged()
    outcome, flights = (fly(), 1) if traced or recorded else fly_long_enough(fly, again)
    if not registry.ours(point.engine.backend):
        _require_work_here(
            point.engine.backend, cpu_time_of_descendants() - charged() - elsewhere, flights, outcome.metrics
        )
    metrics = outcome.metrics | clock.metrics() | {"peak_memory": _peak_memory()}
    if recorded:
        return Result(metrics, plan, outcome.trace, flights, recording_of(point, scene, outcome))
    metrics |= invariance(on_demand, scene, partial(_hits_as_planned, method, plan, law))
    metrics |= roofline(on_demand, len(scene.bodies), plan.keeps("orientations"), metrics)
    if point.reference is not None and not traced:
        if outcome.answers is not None:
            metrics |= accuracy.near_errors(point, files, outcome.answers)
        else:
            metrics |= accuracy.errors(point, files, outcome.trace or hits(point, scene), hits)
    metrics |= from_outcome(scene, replace(outcome, metrics=metrics))
    _require_finite_metrics(metrics)
    return Result(metrics, plan, outcome.trace if traced else None, flights)


def hits(point: Point, scene: Scene) -> Trace:
    """Every hit of a scene flown by the method of a point, with a plan of the scene's own."""
    method, law = method_of_point(point), law_of(point, scene)
    return _hits_as_planned(method, method.plan(scene, law), law, scene)


def _hits_as_planned(method: Method, plan: Plan, law: MotionLaw, scene: Scene, slower: float = 1.0) -> Trace:
    """Every hit of a scene that is like the planned one, flown `slower` times as slowly."""
    trace = method.load(scene, plan).fly(law.slowed(slower), traced=True).trace
    assert trace is not None, "a traced flight has a trace"
    return trace


# Of the time of the flights, and s: so much CPU time may be used elsewhere unseen. To start a process and let it sleep
# takes some hundredths.
_UNSEEN, _FEWEST_SECONDS = 0.2, 0.05


def _require_work_here(backend: str, elsewhere: float, flights: int, metrics: Mapping[str, float]) -> None:
    """Refuse a plugin that lets other processes work, which no clock of a run sees.

    Parameters
    ----------
    elsewhere : s of CPU time that other processes used in so many flights, and that was not charged to this one
    metrics : of one of them
    """
    if elsewhere > max(_FEWEST_SECONDS, _UNSEEN * flights * metrics["run_seconds"]):
        raise ContractError(
            f'backend "{backend}": it works in processes of its own, which used {elsewhere:.2g} s of CPU time that no '
            "clock of a run sees; what is timed must be done in the process that asks it, or charged to it "
            "(harness.cpu_time.charge)"
        )


def _require_finite_metrics(metrics: Mapping[str, float]) -> None:
    wrong = [f"{name} is {value}" for name, value in metrics.items() if not isfinite(value)]
    if wrong:
        raise NotFiniteError(", ".join(wrong))


def _peak_memory() -> float:
    """B, largest resident memory of this process so far."""
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
