"""A laboratory for collision detection: which pipeline, for my scene, at the accuracy I need?

The commands call these functions too; importing this module imports nothing heavy.
"""

from __future__ import annotations

# False, as that of `typing`, whose import takes longest of all that comes before Ctrl-C is heeded.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

    from harness.arrays import Flags, Floats
    from harness.experiment.experiment import Experiment
    from harness.motion.hits import Trace
    from harness.pair.body import Body
    from harness.pair.distance import Distance

DATABASE = "results/results.db"
"""Where results are kept unless somebody names another file."""

__all__ = ["Body", "distance", "load", "results", "run", "time_of_impact", "touching", "trace"]


def __getattr__(name: str) -> object:
    """`Body`, whose module imports numpy, when it is first asked for."""
    if name != "Body":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from harness.pair.body import Body

    return Body


def touching(a: Body, b: Body) -> bool | Flags:
    """Whether two bodies touch: spheres and hulls as solids, meshes as surfaces.

    Proven, either by a point of both or by planes between them, except where the gap or the overlap is within rounding,
    some 1e-15 of the sizes. A surface wholly inside the other does not touch it.

    Parameters
    ----------
    a, b : Body of the same shape; one with arrays of poses is asked about at each of them

    Returns
    -------
    bool, or (n,) bool array

    Raises
    ------
    harness.errors.InputError
        If the shapes differ, or the numbers of poses do.

    Examples
    --------
    >>> import harness
    >>> one = harness.Body("cube.ply")  # 1 across its corners, 0.577 along an edge
    >>> harness.touching(one, harness.Body("cube.ply", position=(0.55, 0, 0)))
    True
    >>> harness.touching(one, harness.Body("cube.ply", position=[(0.55, 0, 0), (0.6, 0, 0)])).tolist()
    [True, False]
    """
    from harness.pair.distance import touching

    return touching(a, b)


def distance(a: Body, b: Body) -> Distance:
    """How far two bodies are apart, and where they are nearest: spheres and hulls as solids, meshes as surfaces.

    The gap is bounded from both sides, from above by the nearest points, from below by planes between all parts of the
    bodies; the bounds meet within 1e-12 of a size, or within rounding of the gap, some 1e-15 of it, where that is more.

    Parameters
    ----------
    a, b : Body of the same shape; one with arrays of poses is asked about at each of them

    Returns
    -------
    Distance
        `gap`, m, 0 where they touch, and `points`, (2, 3) m in the world, of `a` and of `b`; for arrays (n,) and
        (n, 2, 3).

    Raises
    ------
    harness.errors.InputError
        If the shapes differ, or the numbers of poses do.

    Examples
    --------
    >>> import harness
    >>> one, other = harness.Body(None, shape="sphere"), harness.Body(None, (3, 0, 0), shape="sphere")
    >>> gap, points = harness.distance(one, other)
    >>> gap, points.tolist()
    (2.0, [[0.5, 0.0, 0.0], [2.5, 0.0, 0.0]])
    >>> pumpkins = [harness.Body("pumpkin-1753.ply", (0, 0, z)) for z in (0, 1.5)]
    >>> round(harness.distance(*pumpkins).gap, 3)
    0.689
    """
    from harness.pair.distance import distance

    return distance(a, b)


def time_of_impact(a: Body, b: Body, until: float, tolerance: float = 1e-9) -> float | Floats:
    """When two bodies in free flight first touch, at constant velocity and spin.

    Proven: until that time they do not touch, and at it they are no farther apart than the tolerance. Spheres are
    exact. Bodies that come within the tolerance and do not touch may be found to.

    Parameters
    ----------
    a, b : Body of the same shape; one with arrays of motions is asked about for each of them
    until : s, when the search ends; inf for never
    tolerance : gap, of the mean size of both, at which hulls and surfaces count as touching; less than 1e-12 counts as
        1e-12, nearer than which rounding decides

    Returns
    -------
    float, or (n,) float array
        s; 0 if they touch at the start, inf if they do not touch until the end, nan where that was not to be decided.

    Raises
    ------
    harness.errors.InputError
        If the shapes differ, or the numbers of motions do, or the time or the tolerance make no sense.

    Examples
    --------
    >>> import harness
    >>> target = harness.Body("cube.ply", shape="hull")
    >>> shot = harness.Body("cube.ply", position=(10, 0, 0), velocity=(-2, 0, 0), shape="hull")
    >>> round(harness.time_of_impact(target, shot, until=10), 6)
    4.711325
    >>> harness.time_of_impact(target, shot, until=1)
    inf
    """
    from harness.pair.impact import time_of_impact

    return time_of_impact(a, b, until, tolerance)


def load(path: str | Path, **set: object) -> Experiment:
    """Read an experiment file.

    Parameters
    ----------
    path : the YAML file
    **set : leaf values in the place of the file's, as with `--set leaf=value`

    Raises
    ------
    harness.errors.InputError
        With every problem of the file and its meshes at once.

    Examples
    --------
    >>> import harness, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "spheres.yaml")
    >>> _ = path.write_text("{title: Two, scene: {shape: sphere, count: 2, box: [9, 9, 9]}, motion: {duration: 1}}")
    >>> experiment = harness.load(path, count=[2, 3], algorithm="grid")
    >>> experiment.swept, [point.scene.count for point in experiment.points]
    (('count',), [2, 3])
    """
    from harness.runner.preparation import prepare

    (experiment, *_), _ = prepare([path], set)
    return experiment


def run(experiment: Experiment) -> pd.DataFrame:
    """Run every point of an experiment, each repeat in a process of its own, without a database.

    Returns
    -------
    pandas.DataFrame
        A row a run: `experiment`, `point`, `repeat`, `status`, `reason`, a column a leaf, a column a metric.

    Examples
    --------
    >>> import harness, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "spheres.yaml")
    >>> _ = path.write_text("{title: Two, scene: {shape: sphere, count: 2, box: [9, 9, 9]}, motion: {duration: 1}}")
    >>> table = harness.run(harness.load(path, repeats=1))
    >>> table[["status", "frames", "pair_tests"]].values.tolist()
    [['ok', 60.0, 60.0]]
    """
    from harness.runner.sweep import run
    from harness.scene.mesh_child import open_all

    return run(experiment, open_all(experiment.mesh_paths.values(), experiment.poses_paths.values()))


def results(db: str | Path = DATABASE) -> pd.DataFrame:
    """The runs that a database keeps, in the form of `run`.

    Examples
    --------
    >>> import harness, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "spheres.yaml")
    >>> _ = path.write_text("{title: Two, scene: {shape: sphere, count: 2, box: [9, 9, 9]}, motion: {duration: 1}}")
    >>> from harness.cli.main import main
    >>> db = str(path.with_name("results.db"))
    >>> main(["sweep", str(path), "--db", db, "--set", "repeats=1", "--quiet"])  # doctest: +ELLIPSIS
    1 run done (1 ok)...
    0
    >>> harness.results(db)["status"].tolist()
    ['ok']
    """
    from harness.store.tables import runs

    return runs(db)


def trace(experiment: Experiment) -> Trace:
    """Run the first point of an experiment once and keep every hit.

    Raises
    ------
    harness.runner.sweep.RunError
        If the run does not come to its end.

    Examples
    --------
    >>> import harness, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "wall.yaml")
    >>> bodies = "[{position: [0, 0, 0], velocity: [1, 0, 0]}]"
    >>> _ = path.write_text(f"{{title: Wall, scene: {{shape: sphere, bodies: {bodies}, box: [9, 9, 9]}}}}")
    >>> hits = harness.trace(harness.load(path, algorithm="predictive"))
    >>> hits.times.tolist(), hits.walls.tolist()  # half a box less a radius away, at 1 m/s; wall x+
    ([4.0], [1])
    """
    from harness.runner.sweep import trace
    from harness.scene.mesh_child import open_all

    return trace(experiment, open_all(experiment.mesh_paths.values(), experiment.poses_paths.values()))
