"""Parts of two surfaces, a node of either tree of triangles, and the step of searches through both trees.

A search begins with a pair of nodes, and replaces it by the two pairs in which the larger node gives way to its halves,
the deeper one first, until pairs of triangles are left. What is asked of the parts, and when, is up to the search.
That for the least distance (`surface_gap`) takes a step of its own: it leaves blocks of triangles whole, and orders by
bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol, TypeVar

from harness.arrays import Ints
from harness.kernel import strict_step
from harness.narrowphase.triangle_tree import TriangleTree, radius_of

# Pairs of nodes on the way at any time, at most: two a level, and fewer than 64 levels a tree.
DEPTH = 256


class Trees(NamedTuple):
    """The surfaces of bodies a and b."""

    a: TriangleTree
    b: TriangleTree


class NodePair(NamedTuple):
    """A node of either tree."""

    a: int
    b: int


ROOTS, NO_NODES = NodePair(0, 0), NodePair(-1, -1)


class Proximity(NamedTuple):
    """How near two parts are to each other.

    Attributes
    ----------
    wait : s, for which they certainly stay apart: 0 if they may touch now, inf if never or too late to matter
    depth : how near their centres are, squared: 0 to 1, where they just touch, or inf
    """

    wait: float
    depth: float


class Halves(NamedTuple):
    """The two pairs that replace a pair of nodes, the deeper one first, each with its wait as in `Proximity`."""

    first: NodePair
    first_wait: float
    second: NodePair
    second_wait: float


class Placed(Protocol):
    """Where two bodies are: whatever else their parts are placed by, and the factors on their vertices."""

    @property
    def size_a(self) -> float: ...

    @property
    def size_b(self) -> float: ...


Place = TypeVar("Place", bound=Placed)
Disc = TypeVar("Disc")


@strict_step
def halves(
    trees: Trees,
    nodes: NodePair,
    at: Place,
    limit: float,
    disc_a: Callable[[TriangleTree, Place, int], Disc],
    disc_b: Callable[[TriangleTree, Place, int], Disc],
    proximity: Callable[[Disc, Disc, Place, float], Proximity],
) -> Halves:
    """The two pairs that replace a pair of nodes, not both of which are leaves.

    Parameters
    ----------
    trees, nodes : Trees and NodePair
    at : where the bodies are
    limit : as `proximity` has it
    disc_a, disc_b : give the disc of a node of either tree, where the bodies are
    proximity : gives the Proximity of two discs
    """
    right_a, right_b = trees.a.right[nodes.a], trees.b.right[nodes.b]
    larger_a = right_a >= 0 and radius_of(trees.a, nodes.a) * at.size_a >= radius_of(trees.b, nodes.b) * at.size_b
    if right_b < 0 or larger_a:
        left, right = NodePair(nodes.a + 1, nodes.b), NodePair(right_a, nodes.b)
        whole = disc_b(trees.b, at, nodes.b)
        of_left = proximity(disc_a(trees.a, at, left.a), whole, at, limit)
        of_right = proximity(disc_a(trees.a, at, right.a), whole, at, limit)
    else:
        left, right = NodePair(nodes.a, nodes.b + 1), NodePair(nodes.a, right_b)
        whole = disc_a(trees.a, at, nodes.a)
        of_left = proximity(whole, disc_b(trees.b, at, left.b), at, limit)
        of_right = proximity(whole, disc_b(trees.b, at, right.b), at, limit)
    if of_left.depth > of_right.depth:
        left, of_left, right, of_right = right, of_right, left, of_left
    return Halves(left, of_left.wait, right, of_right.wait)


@strict_step
def push_near(stack: Ints, height: int, found: Halves) -> int:
    """Put the pairs that may touch now on a (DEPTH, 2) stack, the deeper one on top; returns its new height."""
    if found.second_wait == 0.0:
        stack[height, 0], stack[height, 1] = found.second
        height += 1
    if found.first_wait == 0.0:
        stack[height, 0], stack[height, 1] = found.first
        height += 1
    return height
