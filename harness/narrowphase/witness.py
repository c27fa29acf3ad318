"""Where two bodies are nearest to each other: the shares that corners of a simplex have in its point nearest to the
origin. The same shares of the vertices that its corners are differences of make one point of either body."""

from __future__ import annotations

from harness.kernel import kernel
from harness.narrowphase.simplex import Simplex, kept, weights
from harness.narrowphase.triangle_distance import nearest_on_flat
from harness.narrowphase.vectors import cross, dot

Shares = tuple[float, float, float, float]


@kernel
def nearest_weights(simplex: Simplex) -> tuple[Simplex, Shares]:
    """The corners that carry the point of a simplex nearest to the origin, and their shares in it.

    Parameters
    ----------
    simplex : of one to three corners that all carry the point, or of four, which hold the origin or are flat
    """
    if simplex.size == 4:
        a, b, c, d = simplex.a, simplex.b, simplex.c, simplex.d
        at_a, at_b = dot(b, cross(c, d)), -dot(a, cross(c, d))
        at_c, at_d = dot(a, cross(b, d)), -dot(a, cross(b, c))
        total = at_a + at_b + at_c + at_d
        if total != 0.0 and min(at_a / total, at_b / total, at_c / total, at_d / total) >= 0.0:
            return simplex, (at_a / total, at_b / total, at_c / total, at_d / total)
        simplex = kept(simplex, nearest_on_flat(a, b, c, d).corners)
    first, second, third = weights(simplex.a, simplex.b, simplex.c, simplex.size)
    return simplex, (first, second, third, 0.0)
