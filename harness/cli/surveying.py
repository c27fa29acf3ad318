"""Experiments with `measure.families` as an atlas of every installed engine, and what is kept of it.

For `compare`, and for `sweep`, which gives an experiment a time. The engines are all that are installed, so that a new
one joins by being there, and the grid of this program.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

from harness.backends.registry import names as declared
from harness.backends.registry import packages
from harness.backends.statement import missing
from harness.compare.atlas import JUDGE, Atlas, AtlasCell, Survey, survey
from harness.compare.budget import Budget, LeftOut, in_sentences
from harness.compare.document import Reduced, document, reduced, shown_case
from harness.compare.gap_atlas import SURVEYS
from harness.compare.outcome import Comparison
from harness.compare.script import script_of
from harness.experiment.experiment import Experiment
from harness.measure.machine import package_versions
from harness.runner.key import point_key
from harness.runner.scene_of_point import build_scene
from harness.runner.servers import files_of
from harness.scene.mesh import Mesh
from harness.scene.scene import Scene
from harness.scene.scene_files import Opened
from harness.vocabulary import EXACT_FRAMES, OWN, Family, Shape
from harness.workers import shared_out

# s for the atlas of an experiment within a sweep; `harness compare` takes as long as it takes.
SWEPT_SECONDS = 170.0

# Of a size: by less no number near 1 differs from its neighbour.
_SMALLEST = 1e-16

RESTING: Family = "resting"
"""The family whose poses are recorded, and not drawn."""


@dataclass(frozen=True)
class Surveyed:
    """An atlas, and the smallest scene of every case of it.

    Parameters
    ----------
    found : as of a comparison: cases, failures, what was left out
    rows : of its cases
    scripts : by place of a case, the Python file that shows it, if there is one
    case_of : by place of a cell, the place of its case
    """

    experiment: Experiment
    atlas: Atlas
    found: Comparison
    rows: list[Reduced]
    scripts: dict[int, str]
    case_of: dict[int, int]

    def cells(self) -> list[dict[str, Any]]:
        """What `--json` and the database have of every cell."""
        return [cell_row(cell) | {"case": self.case_of.get(place)} for place, cell in enumerate(self.atlas.cells)]

    def documents(self) -> Iterator[tuple[tuple[str, str], dict[str, Any]]]:
        """What the database keeps of each engine."""
        rows_of_all = self.cells()
        for engine in dict.fromkeys(cell.engine for cell in self.atlas.cells):
            mine = [place for place, row in enumerate(self.rows) if row.case.wrong == engine]
            found = Comparison(
                cases=[self.rows[place].case for place in mine],
                failures=[failure for failure in self.found.failures if failure.backend == engine],
                unsupported=[line for line in self.found.unsupported if line.startswith(f"{engine} ")],
                left_out=self.found.left_out,
            )
            rows = [self.rows[place] for place in mine]
            cells = [cell for cell in rows_of_all if cell["engine"] == engine]
            for cell in cells:
                cell["case"] = mine.index(cell["case"]) if cell["case"] is not None else None
            shown = [
                shown_case(row) | {"script": self.scripts.get(place)} for place, row in zip(mine, rows, strict=True)
            ]
            yield (
                (engine, JUDGE),
                document(found, rows, {})
                | {
                    "title": self.experiment.title,
                    "shown": shown,
                    "versions": package_versions(packages()),
                    "atlas": cells,
                },
            )


def engines(chosen: Sequence[str] = ()) -> tuple[str, ...]:
    """The engines of an atlas: those chosen, else all that are installed, and the grid of this program."""
    return tuple(chosen) or (*(name for name in declared() if missing(name) is None), EXACT_FRAMES)


@dataclass(frozen=True)
class _Part:
    """What was found in one family of one shape, mesh and query."""

    atlas: Atlas
    rows: list[Reduced]
    left: list[LeftOut]


def surveyed(
    experiment: Experiment,
    meshes: Opened,
    names: Sequence[str],
    budget: Budget,
    progress: Callable[[str], None] = lambda line: None,
    workers: int = 1,
) -> Surveyed:
    """Ask every engine about every family, shape and mesh of an experiment, and make its cases smaller.

    Parameters
    ----------
    experiment, meshes : loaded and opened
    names : of engines
    budget : ends it early
    progress : told what is being asked
    workers : processes that share out the families
    """
    tasks: list[tuple[str, Callable[[], _Part]]] = []
    wanted = {(point.scene.shape, point.scene.mesh_names, point.motion.poses): point for point in experiment.points}
    measure = experiment.measure
    file_of = {mesh.identity: path.name for path, mesh in meshes.items() if isinstance(mesh, Mesh)}
    for (shape, _, _), point in wanted.items():
        files = files_of(experiment, point, meshes)
        recorded = build_scene(point, files, measure.memory) if RESTING in measure.families else None
        only = files.meshes[0] if len(files.meshes) == 1 else None
        for query in measure.family_queries:
            asked = names if query == "collision" else (*names, OWN)
            kinds = [(mesh, family) for mesh in files.meshes or (None,) for family in measure.families]
            kinds = [(mesh, family) for mesh, family in kinds if family != RESTING]
            for mesh, family in kinds if recorded is None else [*kinds, (only, RESTING)]:
                of = f" of {mesh.name}" if mesh is not None and shape != "sphere" else ""
                how = (measure.family_poses, asked, budget, SURVEYS[query], recorded, file_of)
                tasks.append((f"{query}, {family}, {shape}{of}", partial(_part, shape, mesh, family, *how)))

    def begin(place: int) -> None:
        said, _ = tasks[place]
        progress(f"{said}: {measure.family_poses} poses")

    left = list(budget.left)
    parts = dict(_done([task for _, task in tasks], workers, begin))
    atlas, rows = Atlas(), list[Reduced]()
    for place in range(len(tasks)):
        atlas.add(parts[place].atlas)
        rows += parts[place].rows
        left += parts[place].left
    found = Comparison(
        cases=[row.case for row in rows],
        failures=atlas.failures,
        unsupported=atlas.unsupported,
        left_out=in_sentences(left),
    )
    scripts = {
        place: text
        for place, row in enumerate(rows)
        if row.small is not None and (text := script_of(row.small)) is not None
    }
    return Surveyed(experiment, atlas, found, rows, scripts, {cell: place for place, cell in enumerate(atlas.cases)})


def _done(
    tasks: Sequence[Callable[[], _Part]], workers: int, begin: Callable[[int], None]
) -> Iterator[tuple[int, _Part]]:
    """What comes of each, with its place."""
    if workers > 1:
        yield from shared_out(tasks, workers, begin)
        return
    for place, task in enumerate(tasks):
        begin(place)
        yield place, task()


def _part(
    shape: Shape,
    mesh: Mesh | None,
    family: Family,
    count: int,
    names: Sequence[str],
    budget: Budget,
    asks: type[Survey],
    recorded: Scene | None,
    file_of: Mapping[str, str],
) -> _Part:
    before = len(budget.left)
    atlas = survey(shape, mesh, (family,), count, names, budget, asks=asks, recorded=recorded)
    cases = list(atlas.cases.values())
    with budget.paused():
        rows = reduced(Comparison(cases=cases), file_of, len(cases))
    return _Part(atlas, rows, budget.left[before:])


def survey_key(experiment: Experiment, meshes: Opened, name: str) -> str:
    """Of two surveys of an engine with the same key the second would find nothing new."""
    points = sorted({point_key(point, files_of(experiment, point, meshes)) for point in experiment.points})
    measure = experiment.measure
    asked = [measure.families, measure.family_queries, measure.family_poses]
    content = json.dumps([points, name, *asked, package_versions(packages())])
    return hashlib.sha256(content.encode()).hexdigest()


def cell_row(cell: AtlasCell) -> dict[str, Any]:
    """A cell, with its rate and the interval of that; None without verdicts."""
    rate, low, high = cell.per_million if cell.verdicts else (None, None, None)
    return asdict(cell) | {"per_million": rate, "low": low, "high": high}


def cell_text(cell: AtlasCell) -> str:
    """A cell in a line."""
    asked = "" if cell.query == "collision" else f"{cell.query}, "
    seen = f"{asked}{cell.family}, {cell.shape}{f' of {cell.mesh}' if cell.mesh else ''}"
    if not cell.verdicts:
        return f"{cell.engine}: {seen}: no verdict"
    rate, low, high = cell.per_million
    off = "from touching" if cell.query == "collision" else "off"
    wrong = (
        f"{cell.wrong} wrong, {rate:.3g} in a million [{low:.3g}, {high:.3g}], {cell.beyond} of them beyond its "
        f"tolerance, the farthest {_share(cell.deepest)} of a size {off}"
        if cell.wrong
        else f"none wrong, at most {high:.3g} in a million"
    )
    return f"{cell.engine}: {seen}: {cell.verdicts} verdicts, {wrong}; {1e6 * cell.seconds:.3g} µs each"


def _share(deepest: float) -> str:
    return f"{deepest:.3g}" if deepest >= _SMALLEST else f"less than {_SMALLEST:g}"
