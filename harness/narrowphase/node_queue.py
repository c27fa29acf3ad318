"""Pairs of nodes by the time until which they stay apart, the earliest first: a binary heap in two arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from harness.arrays import Floats, Ints
from harness.kernel import kernel, strict_step
from harness.narrowphase.tree_pairs import NodePair


class NodeQueue(NamedTuple):
    """Memory of a heap; its owner counts the pairs in it.

    Attributes
    ----------
    times : (capacity,) float array, s
    nodes : (capacity,) int array, node a << 32 | node b
    """

    times: Floats
    nodes: Ints


@kernel
def node_queue() -> NodeQueue:
    """Of no pairs yet."""
    return NodeQueue(np.empty(64), np.empty(64, np.int64))


@strict_step
def earliest(queue: NodeQueue) -> NodePair:
    """The pair that comes first, of one at least."""
    return NodePair(queue.nodes[0] >> 32, queue.nodes[0] & 0xFFFFFFFF)


@strict_step
def drop_earliest(queue: NodeQueue, count: int) -> int:
    """Take the first of `count` pairs out; returns how many are left."""
    times, nodes = queue.times, queue.nodes
    count -= 1
    time, pair, place = times[count], nodes[count], 0  # the last one sinks from the first place
    while 2 * place + 1 < count:
        child = 2 * place + 1
        if child + 1 < count and times[child + 1] < times[child]:
            child += 1
        if times[child] >= time:
            break
        times[place], nodes[place] = times[child], nodes[child]
        place = child
    times[place], nodes[place] = time, pair
    return count


@strict_step
def enqueue(queue: NodeQueue, count: int, time: float, pair: NodePair) -> int:
    """Put a pair in, for which there is room, besides `count` others; returns how many there are."""
    times, nodes = queue.times, queue.nodes
    place = count
    while place > 0:
        parent = (place - 1) // 2
        if times[parent] <= time:
            break
        times[place], nodes[place] = times[parent], nodes[parent]
        place = parent
    times[place], nodes[place] = time, pair.a << 32 | pair.b
    return count + 1


@kernel
def larger(queue: NodeQueue, count: int) -> NodeQueue:
    """The same `count` pairs in twice the room."""
    times, nodes = np.empty(2 * len(queue.times)), np.empty(2 * len(queue.times), np.int64)
    times[:count], nodes[:count] = queue.times[:count], queue.nodes[:count]
    return NodeQueue(times, nodes)
