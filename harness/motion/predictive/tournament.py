"""The event queue: a tournament tree over the events that the spheres hold.

It works in place, without tuning or horizon: a changed event goes through its matches again, up to the root. Ties go by
(time, kind, i, j), so that a run is the same to the bit whatever sphere happens to hold an event.
"""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.codes import Event
from harness.motion.predictive.state import NEVER, EventQueue, Records


@step
def update(queue: EventQueue, schedule: Records, k: int) -> None:
    """Put the tree in order after the time in sphere k's leaf has changed."""
    bits = queue.time_bits
    winners = queue.winners
    node = bits.size // 2 + k
    time = bits[node]
    who = k
    while node > 1:
        # The winner is carried along, as reading back what was just written would double the time; and it is chosen
        # by a mask (all ones if the rival is earlier), as the branch a compiler makes of a choice is mispredicted
        # half the time.
        rival_time = bits[node ^ 1]
        rival = winners[node ^ 1]
        if rival_time == time and time < NEVER and precedes(schedule, rival, who):
            who = rival
        earlier = (rival_time - time) >> 63
        time += (rival_time - time) & earlier
        who += (rival - who) & earlier
        node = node >> 1
        bits[node] = time
        winners[node] = who


@step
def rebuild(queue: EventQueue, schedule: Records) -> None:
    """Rebuild the whole tree from its leaves."""
    for node in range(queue.times.size // 2 - 1, 0, -1):
        match(queue, schedule, node)


@step
def match(queue: EventQueue, schedule: Records, node: int) -> None:
    """Put the earlier event of a node's two children at the node."""
    bits = queue.time_bits
    winners = queue.winners
    left = bits[2 * node]
    right = bits[2 * node + 1]
    one = winners[2 * node]
    other = winners[2 * node + 1]
    second = right < left
    if left == right and left < NEVER:
        second = precedes(schedule, other, one)
    bits[node] = right if second else left
    winners[node] = other if second else one


@step
def precedes(schedule: Records, a: int, b: int) -> bool:
    """Whether sphere a's event comes before sphere b's of the same time: by kind, then i, then j."""
    return rank(schedule, a) < rank(schedule, b)


@step
def rank(schedule: Records, k: int) -> tuple[int, int, int]:
    """What breaks ties: kind (unscheduled, pair, wall, the rest), lower and higher label."""
    own = schedule[k]
    first = second = own.label
    if own.kind == Event.PAIR:
        partner = schedule[own.partner].label
        first, second = min(first, partner), max(first, partner)
    return min(int(own.kind), Event.CROSSING.value), first, second
