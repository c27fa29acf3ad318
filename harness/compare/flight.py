"""Bodies in flight: two backends fly the same scene, each by its own hits.

Chaos makes of the smallest difference another flight, so that only the time of the first one and averages after it mean
anything. Each backend holds the scene as a run of it would, hulls of its own included.
"""

from __future__ import annotations

from harness.arrays import Floats, Pairs
from harness.compare.isolated import PATIENCE, Isolated, UnusableError
from harness.compare.outcome import Comparison, Failure
from harness.compare.poses import Pose
from harness.compare.side_by_side import side_by_side
from harness.methods.stages import Plan
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.motion.hits import Trace
from harness.motion.law import MotionLaw
from harness.scene.scene import Scene
from harness.vocabulary import MethodName, Response


def fly_both(
    scene: Scene,
    names: tuple[str, str],
    *,
    frames: int,
    dt: float,
    response: Response,
    restitution: float = 1.0,
    patience: float = PATIENCE,
) -> Comparison:
    """Fly a scene with each of two backends, in frames of dt (s).

    Returns
    -------
    Comparison
        With the two flights side by side, or with the failure that ended one.
    """
    traces: list[Trace] = []
    for name in names:
        try:
            with Isolated(name, scene, patience) as asked:
                flying = _Flying(name, asked)
                law = MotionLaw(frames * dt, dt, response, restitution)
                flown = flying.load(scene, flying.plan(scene, law)).fly(law, traced=True)
        except UnusableError as error:
            return Comparison(unsupported=[f"{name} cannot fly shape {scene.shape}: {error}"])
        except _FailedError as error:
            pose = f"frame {flying.call} in flight"
            return Comparison(failures=[Failure(names, name, pose, flying.call, str(error))])
        assert flown.trace is not None, "it was asked for"
        traces.append(flown.trace)
    return Comparison(flights=[side_by_side(names, scene, response, (traces[0], traces[1]))])


class _FailedError(Exception):
    """The backend gave no answer; says why."""


class _Flying(SteppedMethod):
    """A method whose detector is in a process of its own."""

    def __init__(self, name: str, asked: Isolated) -> None:
        super().__init__(MethodName.read(name, asked.shape))
        self._asked, self.call = asked, 0

    def finding(self, count: int) -> str:
        return f"{self.name.backend} is asked in a process of its own"

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        return self

    def pairs(self, positions: Floats, quaternions: Floats) -> Pairs:
        """As a detector: its answer, or the failure that ends the flight."""
        self.call += 1
        answer = self._asked.pairs(Pose(f"frame {self.call}", positions, quaternions))
        if isinstance(answer, str):
            raise _FailedError(answer)
        return answer
