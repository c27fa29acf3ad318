"""Free running: each of two backends moves the same scene by its own hits.

Chaos makes of the smallest difference another motion, so that only the time of the first one and averages after it mean
anything. Each backend holds the scene as a run of it would, hulls of its own included.
"""

from __future__ import annotations

from harness.arrays import Floats, Pairs
from harness.compare.free_run_pair import compare_runs
from harness.compare.isolated import ANSWER_SECONDS, Isolated, UnusableError
from harness.compare.outcome import Comparison, Failure
from harness.compare.poses import Pose
from harness.compare.tally import NamePair
from harness.motion.hits import Trace
from harness.motion.plan import make_plan
from harness.motion.stepped import fly_stepped
from harness.scene.scene import Scene
from harness.vocabulary import Response, Shape


def run_both(
    scene: Scene,
    names: NamePair,
    *,
    frames: int,
    dt: float,
    response: Response,
    restitution: float = 1.0,
    timeout: float = ANSWER_SECONDS,
) -> Comparison:
    """Run a scene with each of two backends, in frames of dt (s).

    Returns
    -------
    Comparison
        With the pair of runs, or with the failure that ended one.
    """
    traces: list[Trace] = []
    for name in names:
        try:
            with Isolated(name, scene, timeout) as asked:
                detector = _Detector(name, asked)
                plan = make_plan(scene, backend=name, algorithm="native", response=response)
                run = fly_stepped(
                    scene, plan, detector, frames=frames, dt=dt, response=response, restitution=restitution, traced=True
                )
        except UnusableError as error:
            return Comparison(unsupported=[f"{name} cannot fly shape {scene.shape}: {error}"])
        except _FailedError as error:
            pose = f"frame {detector.frame} in flight"
            return Comparison(failures=[Failure(names, name, pose, detector.frame, str(error))])
        assert run.trace is not None, "it was asked for"
        traces.append(run.trace)
    return Comparison(flights=[compare_runs(names, scene, response, (traces[0], traces[1]))])


class _FailedError(Exception):
    """The backend gave no answer, and why."""


class _Detector:
    """A backend in a process of its own, as a stepped run asks it."""

    shapes: tuple[Shape, ...] = ("sphere", "hull", "mesh")

    def __init__(self, name: str, asked: Isolated) -> None:
        self.name, self._asked, self.frame = name, asked, 0

    def tolerance(self, shape: Shape) -> float:
        return self._asked.facts.tolerance

    def load(self, scene: Scene) -> None:
        """It is loaded."""

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        self.frame += 1
        answer = self._asked.pairs(Pose(f"frame {self.frame}", positions, quaternions))
        if isinstance(answer, str):
            raise _FailedError(answer)
        return answer
