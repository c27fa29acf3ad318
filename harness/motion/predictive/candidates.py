"""Candidates for the pair events of a sphere, from the cells around it."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.cells import ALL, Layer, block, cell_of, gather_block
from harness.motion.predictive.larger import gather_larger, gather_smaller
from harness.motion.predictive.state import World
from harness.prefetch import prefetch


@step
def gather_candidates(world: World, k: int, now: float, layer: Layer, several: bool) -> int:
    """Candidates from the cells: in one's own grid, and of `several` also larger and smaller ones."""
    cells, place = world.cells, world.spheres.schedule[k]
    own = place.size_class
    if several and own > 0:
        prefetch(cells.larger, cell_of(cells, place))
    around = block(cells.grids[own], place.cell[0], place.cell[1], place.cell[2], layer)
    count = gather_block(cells, cells.grids[own], around, world.scratch.found, 0)
    if several and own > 0:
        count = gather_larger(world, k, cell_of(cells, place), now, count)
    if several and layer.axis == ALL and own < cells.grids.size - 1:
        count = gather_smaller(world, k, count)
    return count
