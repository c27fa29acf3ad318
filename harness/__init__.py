"""A laboratory for collision detection: which pipeline, for my scene, at the accuracy I need?

The functions here are what the commands stand on; importing this module imports nothing heavy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

    from harness.experiment.experiment import Experiment
    from harness.motion.hits import Trace

__all__ = ["load", "results", "run", "trace"]


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
    """
    from harness.runner.preparation import prepare

    return prepare([path], set)[0][0]


def run(experiment: Experiment) -> pd.DataFrame:
    """Run every point of an experiment, each repeat in a process of its own, without a database.

    Returns
    -------
    pandas.DataFrame
        A row a run: `experiment`, `point`, `repeat`, `status`, `reason`, a column a leaf, a column a metric.
    """
    from harness.runner.sweep import run
    from harness.scene.mesh_child import open_all

    return run(experiment, open_all(experiment.mesh_paths.values()))


def results(db: str | Path = "results/results.db") -> pd.DataFrame:
    """The runs that a database keeps, in the form of `run`."""
    from harness.store.tables import runs

    return runs(db)


def trace(experiment: Experiment) -> Trace:
    """Run the first point of an experiment once and keep every hit.

    Raises
    ------
    harness.runner.sweep.RunError
        If the run does not come to its end.
    """
    from harness.runner.sweep import trace
    from harness.scene.mesh_child import open_all

    return trace(experiment, open_all(experiment.mesh_paths.values()))
