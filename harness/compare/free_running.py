"""Free running: each of two backends moves the same scene by its own hits.

Chaos makes of the smallest difference another motion, so that only the time of the first one and averages after it mean
anything. Each backend holds the scene as a run of it would, hulls of its own included.
"""

from __future__ import annotations

from harness.arrays import Floats, Pairs
from harness.compare.budget import Budget
from harness.compare.free_run_pair import compare_runs
from harness.compare.isolated import ANSWER_SECONDS, Isolated, UnusableError
from harness.compare.outcome import Comparison, Failure
from harness.compare.poses import Pose
from harness.compare.tally import NamePair
from harness.methods.stages import Plan
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.motion.hits import Outcome, Trace
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Response


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
                method = _IsolatedMethod(name, scene, asked)
                run = method.run(scene, MotionLaw(frames * dt, dt, response, restitution), traced=True)
        except UnusableError as error:
            return Comparison(unsupported=[f"{name} cannot fly shape {scene.shape}: {error}"])
        except _FailedError as error:
            pose = f"frame {method.frame} in flight"
            return Comparison(failures=[Failure(names, name, pose, method.frame, str(error))])
        assert run.trace is not None, "it was asked for"
        traces.append(run.trace)
    return Comparison(free_runs=[compare_runs(names, scene, response, (traces[0], traces[1]))])


def digest_when_asked(scene: Scene, name: str, law: MotionLaw, budget: Budget) -> float | None:
    """The `event_digest` of a run whose backend is asked frame by frame in a process of its own, and not timed.

    None where it fails, which is found otherwise, and where the time is spent before the flight ends.
    """
    try:
        with Isolated(name, scene) as asked:
            return _IsolatedMethod(name, scene, asked, budget).run(scene, law).metrics["event_digest"]
    except (UnusableError, _FailedError):
        return None


class _FailedError(Exception):
    """The backend gave no answer, and why."""


class _IsolatedMethod(SteppedMethod):
    """A method whose detector is in a process of its own."""

    def __init__(self, name: str, scene: Scene, asked: Isolated, budget: Budget | None = None) -> None:
        # no depth is asked for here
        super().__init__(MethodName.read(name, scene.shape), forced={"penetration": False})
        self._asked, self._budget, self.frame = asked, budget or Budget(), 0

    def run(self, scene: Scene, law: MotionLaw, *, traced: bool = False) -> Outcome:
        """Fly the scene."""
        return self.load(scene, self.plan(scene, law)).fly(law, traced=traced)

    def finding(self, count: int) -> str:
        return f"{self.name.backend} is asked in a process of its own"

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        return self

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        """As a detector: the answer, or the failure that ends the run."""
        self.frame += 1
        if self._budget.spent:
            raise _FailedError(self._budget.why)
        answer = self._asked.pairs(Pose(f"frame {self.frame}", positions, quaternions))
        if isinstance(answer, str):
            raise _FailedError(answer)
        return answer
