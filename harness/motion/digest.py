"""A digest of a sequence of hits: two runs with the same digest have answered the same hits in the same order."""

from __future__ import annotations

import struct
from hashlib import blake2b

import numpy as np

from harness.arrays import Flags, Ints, Pairs

# The bits of the digest, so few that a float holds it exactly.
BITS = 52


class EventDigest:
    """Hashes hits as they are answered, frame by frame: when, who met whom, and who met which wall."""

    def __init__(self) -> None:
        self._hash = blake2b(digest_size=8)

    def add_pairs(self, time: float, pairs: Pairs) -> None:
        """Take in answered pairs, (k, 2), in order; time in s."""
        self._add(b"p", time, pairs)

    def add_walls(self, time: float, hits: Ints | Flags) -> None:
        """Take in wall hits, (n, 6) how often which body hit which wall."""
        bodies, walls = np.nonzero(hits)
        self._add(b"w", time, np.column_stack([bodies, walls, hits[bodies, walls]]))

    @property
    def value(self) -> float:
        """A whole number from 1 to 2^52."""
        return float((int.from_bytes(self._hash.digest(), "little") >> (64 - BITS)) + 1)

    def _add(self, kind: bytes, time: float, rows: Ints) -> None:
        self._hash.update(struct.pack("<cdq", kind, time, len(rows)))
        self._hash.update(np.ascontiguousarray(rows, "<i8").data)
