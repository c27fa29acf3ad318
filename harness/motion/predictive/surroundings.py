"""What is around a sphere in the cells: who, and where its own cell ends."""

from __future__ import annotations

from math import inf, sqrt

from harness.kernel import step
from harness.motion.predictive.cells import ALL, gather_around, gather_ball, index
from harness.motion.predictive.state import GRID, PLACE, RADIUS, TIME, VX, Cells, World, X


@step
def gather(world: World, k: int, now: float, axis: int, step: int) -> int:
    """Candidates from the cells: one's own grid, coarser grids around, finer grids within reach."""
    cells, rows, found = world.cells, world.spheres.rows, world.scratch.candidates
    marks = world.spheres.marks
    own = int(marks[k, GRID])
    count = gather_around(cells, own, marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2], axis, step, found, 0)
    if cells.shapes.shape[0] > 1:
        flown = now - rows[k, TIME]
        x = rows[k, X] + rows[k, VX] * flown
        y = rows[k, X + 1] + rows[k, VX + 1] * flown
        z = rows[k, X + 2] + rows[k, VX + 2] * flown
        for grid in range(own):
            ix, iy, iz = index(cells, grid, 0, x), index(cells, grid, 1, y), index(cells, grid, 2, z)
            count = gather_around(cells, grid, ix, iy, iz, ALL, 0, found, count)
        if axis == ALL and own < cells.shapes.shape[0] - 1:
            margin = cells.frames[own, 7]
            for grid in range(own + 1, cells.shapes.shape[0]):
                reach = rows[k, RADIUS] + cells.frames[grid, 6] + margin
                count = gather_ball(cells, grid, x, y, z, reach, found, count)
            speed = sqrt(rows[k, VX] ** 2 + rows[k, VX + 1] ** 2 + rows[k, VX + 2] ** 2)
            cells.renewals[k] = now + 0.999 * margin / speed if speed > 0.0 else inf
    return count


@step
def next_face(cells: Cells, grid: int, axis: int, place: int, up: int) -> float:
    """Where a cell begins along an axis, or the infinity that one moves to beyond the outermost cells."""
    if 0 < place < cells.shapes[grid, axis]:
        return float(cells.frames[grid, axis] + place * cells.frames[grid, 3 + axis])
    return inf if up == 1 else -inf
