"""Who is around a sphere in the cells."""

from __future__ import annotations

from math import inf, sqrt

from harness.kernel import step
from harness.motion.predictive.cells import ALL, AROUND, Layer, block, gather_ball, gather_block, index
from harness.motion.predictive.state import World


@step
def gather(world: World, k: int, now: float, layer: Layer) -> int:
    """Candidates from the cells: one's own grid, coarser grids around, finer grids within reach."""
    cells, grids, found = world.cells, world.cells.grids, world.scratch.found
    motion, place = world.spheres.motions[k], world.spheres.schedule[k]
    own = place.size_class
    around = block(grids[own], place.cell[0], place.cell[1], place.cell[2], layer)
    count = gather_block(cells, grids[own], around, found, 0)
    if grids.size > 1:
        flown = now - motion.time
        x = motion.position[0] + motion.velocity[0] * flown
        y = motion.position[1] + motion.velocity[1] * flown
        z = motion.position[2] + motion.velocity[2] * flown
        for coarser in range(own):
            grid = grids[coarser]
            around = block(grid, index(grid, 0, x), index(grid, 1, y), index(grid, 2, z), AROUND)
            count = gather_block(cells, grid, around, found, count)
        if layer.axis == ALL and own < grids.size - 1:
            margin = grids[own].margin
            for finer in range(own + 1, grids.size):
                reach = motion.radius + grids[finer].largest + margin
                count = gather_ball(cells, grids[finer], x, y, z, reach, found, count)
            speed = sqrt(motion.velocity[0] ** 2 + motion.velocity[1] ** 2 + motion.velocity[2] ** 2)
            cells.renewals[k] = now + 0.999 * margin / speed if speed > 0.0 else inf
    return count
