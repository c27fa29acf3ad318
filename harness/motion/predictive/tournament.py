"""The next event: a tournament tree over the events the spheres hold.

In place, without tuning or horizon: a changed event replays its matches on the way to the root. Ties go by
(time, kind, i, j), so that a run is the same to the bit whatever sphere happens to hold an event.
"""

from __future__ import annotations

import numpy as np

from harness.kernel import step
from harness.motion.predictive.state import NOTHING, PAIR, WALL, Agenda, Records

NEVER = int(np.array(np.inf).view(np.int64))


@step
def replay(agenda: Agenda, schedule: Records, k: int) -> None:
    """Let sphere k's event, already written to its leaf, find its way up."""
    order = agenda.order
    winners = agenda.winners
    node = order.size // 2 + k
    time = order[node]
    who = k
    while node > 1:
        # The winner is carried along, as reading back what was just written would double the time; and it is chosen
        # by a mask (all ones if the rival is earlier), as the branch a compiler makes of a choice is mispredicted
        # half the time.
        rival_time = order[node ^ 1]
        rival = winners[node ^ 1]
        if rival_time == time and time < NEVER and precedes(schedule, rival, who):
            who = rival
        earlier = (rival_time - time) >> 63
        time += (rival_time - time) & earlier
        who += (rival - who) & earlier
        node = node >> 1
        order[node] = time
        winners[node] = who


@step
def rebuild(agenda: Agenda, schedule: Records) -> None:
    """Play all matches."""
    for node in range(agenda.times.size // 2 - 1, 0, -1):
        match(agenda, schedule, node)


@step
def match(agenda: Agenda, schedule: Records, node: int) -> None:
    """The earlier event of a node's two children stands at the node."""
    order = agenda.order
    winners = agenda.winners
    left = order[2 * node]
    right = order[2 * node + 1]
    one = winners[2 * node]
    other = winners[2 * node + 1]
    second = right < left
    if left == right and left < NEVER:
        second = precedes(schedule, other, one)
    order[node] = right if second else left
    winners[node] = other if second else one


@step
def precedes(schedule: Records, a: int, b: int) -> bool:
    """Whether sphere a's event comes before sphere b's of the same time: by kind, then i, then j."""
    kind_a, first_a, second_a = key(schedule, a)
    kind_b, first_b, second_b = key(schedule, b)
    if kind_a != kind_b:
        return kind_a < kind_b
    if first_a != first_b:
        return first_a < first_b
    return second_a < second_b


@step
def key(schedule: Records, k: int) -> tuple[int, int, int]:
    """What breaks ties: kind (fresh, pair, wall, the rest), lower and higher label, or label and face."""
    kind = schedule[k].kind
    label = schedule[k].label
    if kind == PAIR:
        partner = schedule[schedule[k].partner].label
        return PAIR, min(label, partner), max(label, partner)
    if kind < PAIR:
        return kind, label, 0
    if kind < WALL + 6:
        return WALL, label, kind - WALL
    return NOTHING, label, kind
