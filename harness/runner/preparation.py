"""Before any run: load experiments, open their meshes in one limited child process, and report all problems at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from harness.backends import registry
from harness.backends.statement import missing
from harness.errors import InputError, NotInstalledError, Problem
from harness.experiment.experiment import Experiment, Point
from harness.experiment.files import find_experiments
from harness.experiment.load import Names, load
from harness.measure.metrics import METRICS, ON_DEMAND
from harness.methods.stages import StageError
from harness.scene.mesh import NO_HULL, Mesh
from harness.scene.mesh_child import open_files
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene_files import Opened


class Prepared(NamedTuple):
    """The valid experiments, their meshes and poses by file, the problems of the others, and what others lack here."""

    experiments: list[Experiment]
    meshes: Opened
    problems: list[Problem]
    lacking: list[Problem]


def prepare(
    paths: Iterable[str | PathLike[str]],
    overrides: Mapping[str, object],
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[list[Experiment], Opened]:
    """Load every experiment that the paths name, and open all of their meshes in one child process.

    Those whose meshes lie in a package that is not installed are passed over.

    Parameters
    ----------
    paths, overrides : as the user gave them
    tell : is given a sentence on each that is passed over

    Raises
    ------
    NotInstalledError
        If all of them would be passed over.
    InputError
        With everything that is wrong with any of them.
    """
    experiments, meshes, problems, lacking = examine(paths, overrides)
    if problems:
        raise InputError(problems)
    if not experiments:
        raise NotInstalledError(lacking)
    for problem in lacking:
        tell(f"{problem}; its points are passed over")
    return experiments, meshes


def known_names() -> Names:
    """The names of all backends that are declared, installed or not, with their abilities, and those of metrics."""
    return Names(registry.names(), METRICS, registry.abilities_of)


def examine(paths: Iterable[str | PathLike[str]], overrides: Mapping[str, object]) -> Prepared:
    """As `prepare`, but returns what is wrong beside what is right.

    Raises
    ------
    InputError
        If a path names no experiment.
    """
    loaded: list[Experiment] = []
    problems: list[Problem] = []
    lacking: list[Problem] = []
    names = known_names()
    for path in find_experiments(paths):
        try:
            loaded.append(load(path, overrides, names))
        except NotInstalledError as error:
            lacking += error.problems
        except InputError as error:
            problems += error.problems
    meshes, broken = _open_files(loaded)
    valid = []
    for experiment in loaded:
        found = [
            *_without_backends(experiment),
            *_file_problems(experiment, meshes, broken),
            *_namesakes(experiment, loaded),
        ]
        found = found or list(_forced(experiment, meshes))
        problems += sorted(found, key=lambda problem: (problem.line or 0, problem.column or 0))
        if not found:
            valid.append(experiment)
    return Prepared(valid, meshes, list(dict.fromkeys(problems)), lacking)


def _open_files(experiments: Sequence[Experiment]) -> tuple[Opened, dict[Path, str]]:
    paths = list(dict.fromkeys(path for experiment in experiments for path in experiment.mesh_paths.values()))
    poses = list(dict.fromkeys(path for experiment in experiments for path in experiment.poses_paths.values()))
    if not paths and not poses:
        return {}, {}
    opened = open_files(paths, poses)
    meshes = {path: mesh for path, mesh in opened.items() if not isinstance(mesh, str)}
    return meshes, {path: message for path, message in opened.items() if isinstance(message, str)}


def _file_problems(experiment: Experiment, opened: Opened, broken: Mapping[Path, str]) -> Iterator[Problem]:
    yield from _mesh_problems(experiment, opened, broken)
    for name, path in experiment.poses_paths.items():
        if path in broken:
            yield experiment.leaf_problem("poses", name, broken[path])
            continue
        recorded, counts = opened[path], {_bodies(point) for point in experiment.points if point.motion.poses == name}
        assert isinstance(recorded, RecordedPoses)
        for count in sorted(counts - {recorded.bodies}):
            yield experiment.leaf_problem(
                "poses", name, f"{path.name} has poses of {recorded.bodies} bodies, not {count}"
            )
    if experiment.poses_paths and (asked := sorted(experiment.metrics & ON_DEMAND)):
        message = f"{asked[0]} is not known of recorded poses"
        yield experiment.leaf_problem("poses", next(iter(experiment.poses_paths)), message)


def _bodies(point: Point) -> int:
    return len(point.scene.bodies) if point.scene.bodies is not None else point.scene.count or 0


def _mesh_problems(experiment: Experiment, meshes: Opened, broken: Mapping[Path, str]) -> Iterator[Problem]:
    of_hulls = (point.scene.mesh_names for point in experiment.points if point.scene.shape == "hull")
    hulls = {name for names in of_hulls for name in names}
    for reference, path in experiment.mesh_paths.items():
        if path in broken:
            yield from experiment.mesh_problems(reference, broken[path])
        elif isinstance(mesh := meshes[path], Mesh) and mesh.flat and reference in hulls:
            yield from experiment.mesh_problems(reference, f"{path.name}: {NO_HULL}")


def _namesakes(experiment: Experiment, experiments: Sequence[Experiment]) -> Iterator[Problem]:
    """Results are kept under the names of experiments, so names must differ."""
    for other in experiments:
        if other is experiment:
            return
        if other.name == experiment.name:
            message = f'this is called "{experiment.name}" as {other.path} is; results are kept by name: rename one'
            yield experiment.problem((), message)


def _forced(experiment: Experiment, meshes: Opened) -> Iterator[Problem]:
    """Stages that are forced where that would change a result, or that do not exist, as the points' plans tell."""
    forcing = [point for point in experiment.points if point.engine.stages]
    if not forcing:
        return
    from harness.runner.point import plan_of  # half a second, which most experiments need not spend
    from harness.runner.scene_of_point import SceneSizeError, build_scene
    from harness.runner.servers import files_of
    from harness.scene.launch import PlacementError

    refused: set[tuple[str, str]] = set()
    for declared in forcing:
        # a plan does not look at the places, which take a compiler to find
        point = replace(declared, scene=declared.scene.model_copy(update={"overlap": "allow"}))
        try:
            plan_of(point, build_scene(point, files_of(experiment, point, meshes), experiment.measure.memory))
        except StageError as error:
            for stage, message in error.refusals:
                if (stage, message) not in refused:
                    refused.add((stage, message))
                    yield experiment.leaf_problem("stages", point.engine.stages, message, (stage,))
        except (PlacementError, SceneSizeError, InputError):  # the run will say it
            continue


def _without_backends(experiment: Experiment) -> Iterator[Problem]:
    """Backends that are not installed, where there is no other.

    Of several they are passed over.
    """
    named = list(dict.fromkeys(point.engine.backend for point in experiment.points))
    lacking = {name: why for name in named if (why := missing(name)) is not None}
    if named and len(lacking) == len(named):
        for name, why in lacking.items():
            yield experiment.leaf_problem("backend", name, why)
