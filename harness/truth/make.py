"""Makes a set of cases: drafts of every family, each with bounds that are proven; what cannot be proven is left out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from harness.arrays import Floats, Ints
from harness.errors import InputError
from harness.scene.mesh import Mesh, Surface
from harness.truth.cases import Cases, joined
from harness.truth.declaration import FamilySpec, TruthDeclaration
from harness.truth.engine_mesh import engine_mesh
from harness.truth.families import FAMILIES, Drafts, Draw
from harness.truth.flights import Flights
from harness.truth.proof import WIDEST, apart, prove, touching
from harness.truth.solids import Solids

# Drafts that share their meshes and sizes, and groups of them whose proofs are done together.
GROUP, GROUPS = 10, 6
# s before and after a time: of the engine, which may be early, and of one at which they are proven to touch.
_BRACKET, _AROUND_PROVEN = (4e-10, 5e-10), (9.5e-10, 1e-11)
# Of the time after the engine's in which a touch is looked for, from 1e-9 s.
_DOUBLINGS = 22
_DIGITS = 12
# Of the vertices: digits after the point, and a factor that keeps rounded ones inside their sphere.
_VERTEX_DIGITS, _INSIDE = 8, 1.0 - 1e-7


@dataclass
class Making:
    """What becomes of a declaration.

    Parameters
    ----------
    surfaces : of the meshes, by name
    cases : proven, of each family
    left_out : of each family the drafts that could not be proven
    moved : cases whose bounds are not where the engine said, by more than they are apart
    """

    surfaces: dict[str, Surface]
    solids: Solids
    cases: dict[str, list[Cases]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    moved: int = 0

    def made(self, family: str) -> int:
        """How many cases of a family there are."""
        return sum(cases.number for cases in self.cases[family])

    def all(self) -> Cases:
        """All cases, family by family."""
        return joined([cases for family in self.cases.values() for cases in family])


def make(
    declaration: TruthDeclaration,
    meshes: Mapping[Path, Mesh],
    budget: float,
    progress: Callable[[str], None],
) -> Making:
    """Draw and prove cases.

    Parameters
    ----------
    declaration : TruthDeclaration
    meshes : those that it names, by file
    budget : s, after which no more are drawn
    progress : told a line now and then
    """
    names = _names(declaration)
    surfaces = {names[path]: _published(meshes[path]) for path in names}
    engine = {name: engine_mesh(name, surface) for name, surface in surfaces.items()}
    used = [
        ("" if shape == "sphere" else names[declaration.meshes[mesh]], shape)
        for family in declaration.families.values()
        for mesh in family.meshes
        for shape in family.shapes
    ]
    making = Making(surfaces, Solids(surfaces, used))
    waiting = dict.fromkeys(declaration.families, 0)
    for name in waiting:
        making.cases[name], making.left_out[name] = [], 0
    start = perf_counter()
    while waiting and perf_counter() - start < budget:
        # the family that is farthest behind, so that all are as far when time is up
        name = min(waiting, key=lambda family: making.made(family) / declaration.families[family].count)
        spec = declaration.families[name]
        place = list(declaration.families).index(name)
        rng = np.random.default_rng([declaration.spec.seed, place, waiting[name]])
        waiting[name] += 1
        drafts = [_draft(name, spec, declaration, names, engine, making.solids, rng) for _ in range(GROUPS)]
        proven, left = _proven(joined([cases for cases, _ in drafts]), np.concatenate([t for _, t in drafts]), making)
        making.left_out[name] += left
        making.cases[name].append(proven.some(np.arange(min(proven.number, spec.count - making.made(name)))))
        so_far = f"{name}: {making.made(name)} of {spec.count}, {making.left_out[name]} left out"
        progress(f"{so_far}, {perf_counter() - start:.0f} s")
        if making.made(name) >= spec.count:
            del waiting[name]
    return making


def _names(declaration: TruthDeclaration) -> dict[Path, str]:
    """What the meshes are called in the set: as their files are."""
    names = {path: path.stem for path in declaration.meshes.values()}
    if len(set(names.values())) < len(names):
        raise InputError(f"{declaration.path}: two of the meshes have files of the same name; rename one")
    return names


def _published(mesh: Mesh) -> Surface:
    """The surface with few digits, which is what the set is about."""
    return Surface(np.round(mesh.vertices * _INSIDE, _VERTEX_DIGITS) + 0.0, mesh.faces)


def _draft(
    name: str,
    spec: FamilySpec,
    declaration: TruthDeclaration,
    names: Mapping[Path, str],
    engine: Mapping[str, Mesh],
    solids: Solids,
    rng: np.random.Generator,
) -> tuple[Cases, Floats]:
    """Drafts of a family for one pair of meshes and sizes, without bounds, and when the engine says that they touch."""
    shape = spec.shapes[rng.integers(len(spec.shapes))]
    chosen = [names[declaration.meshes[spec.meshes[rng.integers(len(spec.meshes))]]] for _ in "ab"]
    size = round(float(spec.size.sample(rng, 1)[0]), 3)
    sizes = size, round(size * float(spec.ratio.sample(rng, 1)[0]), 5)
    draw = Draw(rng, spec, (engine[chosen[0]], engine[chosen[1]]), shape, sizes, GROUP)
    drafts, kept = FAMILIES[name](draw)
    times = draw.first_touch(drafts)
    rows = np.flatnonzero(kept)
    sides = [_side(drafts, k, solids.number(chosen[k], shape), sizes[k]).some(rows) for k in (0, 1)]
    windows = drafts.windows[rows]
    cases = Cases(np.full(len(rows), name), sides[0], sides[1], windows, windows, np.full(len(rows), np.inf))
    return cases, times[rows]


def _side(drafts: Drafts, side: int, solid: int, size: float) -> Flights:
    count = len(drafts.windows)
    return Flights(np.full(count, solid), np.full(count, size), *(column[side] for column in drafts[:4]))


def _proven(cases: Cases, times: Floats, making: Making) -> tuple[Cases, int]:
    """The cases with bounds that are proven, and how many have none."""
    found: list[Cases] = []

    def keep(rows: Ints, candidates: Floats, before: float, after: float) -> Ints:
        """Keep what is proven with these bounds; returns the rows that are not."""
        tried = _bracketed(cases.some(rows), candidates, before, after)
        open_ = np.array([reason != "" for reason in prove(tried, making.solids)], np.bool_)
        found.append(tried.some(np.flatnonzero(~open_)))
        hits = ~open_ & np.isfinite(candidates)
        making.moved += int((~(np.abs(candidates[hits] - times[rows][hits]) <= WIDEST)).sum())
        return np.asarray(rows[open_])

    rows = keep(np.arange(cases.number), times, *_BRACKET)
    if len(rows):
        slow = rows[np.isfinite(times[rows]) & (times[rows] > 0.0)]
        later = keep(slow, _first_proven(cases.some(slow), times[slow], making.solids), *_AROUND_PROVEN)
        rows = np.union1d(np.setdiff1d(rows, slow), later)
    if len(rows):
        # the engine may be late, or have missed it: where the proof comes to a halt, they may touch
        until = np.where(np.isfinite(times[rows]), times[rows], cases.windows[rows])
        _, halted = apart(cases.some(rows), making.solids, until)
        known = np.isfinite(halted)
        rows = np.union1d(rows[~known], keep(rows[known], halted[known], *_BRACKET))
    return joined(found), len(rows)


def _first_proven(cases: Cases, times: Floats, solids: Solids) -> Floats:
    """(n,) s: about the first time at which bodies are proven to touch, after times at which they are very near.

    Bodies that close slowly come within the engine's tolerance long before they touch.
    """
    low, high = times.copy(), np.full(len(times), np.nan)
    for step in range(_DOUBLINGS):
        left = np.flatnonzero(np.isnan(high))
        if not len(left):
            break
        later = times[left] + WIDEST * 2.0**step
        touch = np.array(touching(cases.some(left), solids, later), bool)
        high[left[touch]], low[left[~touch]] = later[touch], later[~touch]
    for _ in range(_DOUBLINGS):
        left = np.flatnonzero(high - low > WIDEST / 10.0)
        if not len(left):
            break
        middle = (low[left] + high[left]) / 2.0
        touch = np.array(touching(cases.some(left), solids, middle), bool)
        high[left[touch]], low[left[~touch]] = middle[touch], middle[~touch]
    return np.where(np.isnan(high), times, high)


def _bracketed(cases: Cases, times: Floats, before: float, after: float) -> Cases:
    """The cases with bounds around times; 0 and 0 where they touch at the start."""
    never, start = ~np.isfinite(times), times == 0.0
    lower = np.where(start, 0.0, np.where(never, cases.windows, np.round(times - before, _DIGITS)))
    upper = np.where(start, 0.0, np.where(never, np.inf, np.round(times + after, _DIGITS)))
    return cases._replace(lower=np.maximum(lower, 0.0), upper=upper)
