"""What a replay shows, put together from a scene and the flight that was recorded; and which points a sweep records."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.experiment.experiment import Point
from harness.motion.hits import Outcome
from harness.runner.point import is_stepped
from harness.scene.scene import Scene
from harness.store.recording import Recording, Surface

if TYPE_CHECKING:
    import pandas as pd

# A sweep records a scene of at most this many bodies and hits, whose run took at most this long (s): all of an
# experiment's page together, and of a default sweep a few seconds.
MOST_BODIES = 500
MOST_HITS = 5000
MOST_SECONDS = 0.5


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
        dt=point.motion.dt if is_stepped(point) else None,
        half_box=scene.box.half,
        sizes=bodies.sizes,
        quaternions=bodies.quaternions,
        spins=bodies.spins,
        surfaces=tuple(Surface(mesh.name, mesh.digest, mesh.vertices, mesh.faces) for mesh in shown),
        surface_of=scene.mesh_of,
        leg_times=course.times,
        leg_bodies=course.bodies,
        leg_positions=course.positions,
        leg_velocities=course.velocities,
        hit_times=trace.times,
        hit_bodies=trace.bodies,
        hit_walls=trace.walls,
    )


def worth_recording(keys: Sequence[str], runs: pd.DataFrame) -> str | None:
    """The point of an experiment that its page should replay: of those that are small enough, the fullest scene.

    Parameters
    ----------
    keys : of its points, in order; of two equally full ones the first is chosen
    runs : its run table; the conditions of a run do not matter, its time does

    Returns
    -------
    The key, or None where no run is small enough.

    Examples
    --------
    >>> import pandas as pd
    >>> points = {"point": ["few", "many"], "count": [5, 50]}
    >>> runs = pd.DataFrame({**points, "status": "ok", "events": 9, "run_seconds": 0.1})
    >>> worth_recording(["few", "many"], runs)
    'many'
    """
    if not {"events", "count", "run_seconds"}.issubset(runs.columns):
        return None
    small = runs[
        (runs["status"] == "ok")
        & (runs["count"] <= MOST_BODIES)
        & (runs["events"] <= MOST_HITS)
        & (runs["run_seconds"] <= MOST_SECONDS)
    ]
    fullest = dict(zip(small["point"], small["count"], strict=True))
    return max((key for key in keys if key in fullest), key=lambda key: fullest[key], default=None)
