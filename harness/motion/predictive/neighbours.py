"""Neighbour lists: who can touch whom before either has moved half the skin from its anchor.

Best in a dense fluid, where a sphere collides many times before it leaves its cage. Anchors stand in the cells;
leaving the neighbourhood of one's anchor is an event, which makes this sphere's list anew and mends those of its
neighbours.
"""

from __future__ import annotations

from math import inf, sqrt

from harness.kernel import step
from harness.motion.predictive.cells import ALL, gather_around, remove, settle
from harness.motion.predictive.state import CAPACITY, PLACE, RADIUS, TIME, VX, Cells, Floats, Indices, Ints, Lists, X


@step
def renew(cells: Cells, lists: Lists, rows: Floats, marks: Ints, k: int, skin: float, found: Indices) -> bool:
    """Anchor sphere k where it is (its row stands at the present) and list its neighbours. False: no room in a list."""
    members = lists.members
    for m in range(1, members[k, 0] + 1):
        strike_out(members, members[k, m], k)
    for axis in range(3):
        lists.anchors[k, axis] = rows[k, X + axis]
    remove(cells, marks, k)
    settle(cells, rows, marks, k)
    count = gather_around(cells, 0, marks[k, PLACE], marks[k, PLACE + 1], marks[k, PLACE + 2], ALL, 0, found, 0)
    degree = 0
    room = True
    for m in range(count):
        p = found[m]
        if p != k and near(lists, rows, k, p, skin):
            if degree == CAPACITY - 1 or members[p, 0] == CAPACITY - 1:
                room = False
                break
            degree += 1
            members[k, degree] = p
            members[p, 0] += 1
            members[p, members[p, 0]] = k
    members[k, 0] = degree
    return room


@step
def near(lists: Lists, rows: Floats, k: int, p: int, skin: float) -> bool:
    """Whether two anchors are within the radii and the skin."""
    anchors = lists.anchors
    x, y, z = anchors[p, 0] - anchors[k, 0], anchors[p, 1] - anchors[k, 1], anchors[p, 2] - anchors[k, 2]
    reach = rows[k, RADIUS] + rows[p, RADIUS] + skin
    return bool(x * x + y * y + z * z < reach * reach)


@step
def strike_out(members: Indices, p: int, k: int) -> None:
    """Take k off p's list."""
    last = members[p, 0]
    for m in range(1, last):
        if members[p, m] == k:
            members[p, m] = members[p, last]
            break
    members[p, 0] = last - 1


@step
def time_to_leave(lists: Lists, rows: Floats, k: int, skin: float) -> float:
    """When sphere k will be half a skin away from its anchor, on its own clock; inf at rest."""
    anchors = lists.anchors
    x, y, z = rows[k, X] - anchors[k, 0], rows[k, X + 1] - anchors[k, 1], rows[k, X + 2] - anchors[k, 2]
    speed = rows[k, VX] * rows[k, VX] + rows[k, VX + 1] * rows[k, VX + 1] + rows[k, VX + 2] * rows[k, VX + 2]
    outward = x * rows[k, VX] + y * rows[k, VX + 1] + z * rows[k, VX + 2]
    # A little early, so that rounding cannot make it late
    left = 0.2499 * skin * skin - (x * x + y * y + z * z)
    root = sqrt(max(outward * outward + speed * left, 0.0))
    return rows[k, TIME] + max((root - outward) / speed, 0.0) if speed > 0.0 else inf
