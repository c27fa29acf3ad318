"""The contacts of a motion without response: which pairs touch, from when until when.

An *encounter* is a time during which the bounding spheres of a pair touch. Within it the bodies themselves may touch
once, several times, or not at all; of spheres the encounter is the one contact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.arrays import Flags, Floats, Ints, Pairs
from harness.scene.ignored_pairs import kept


@dataclass(frozen=True, eq=False)
class Contacts:
    """Every contact of every pair in [0, duration], the ends included: touching is not overlap, but it is a contact.

    Parameters
    ----------
    duration : s
    pairs : (k, 2) int array, the pair of each encounter, i < j, sorted by pair and then by time
    begin, end : (k,) float arrays, s; the encounter, cut to the duration
    encounter : (m,) int array, the encounter of each contact, in order
    onset, release : (m,) float arrays, s; the contact, cut likewise. An onset of 0 is no onset: the bodies touched
        already.
    """

    duration: float
    pairs: Pairs
    begin: Floats
    end: Floats
    encounter: Ints
    onset: Floats
    release: Floats

    @classmethod
    def of_spheres(cls, duration: float, pairs: Pairs, begin: Floats, end: Floats) -> Contacts:
        """The contacts of spheres: each encounter is one."""
        return cls(duration, pairs, begin, end, np.arange(len(begin)), begin, end)

    def encounters_without(self, ignored: Pairs) -> Contacts:
        """Of encounters of spheres, those of pairs that are not ignored, (m, 2) int array."""
        if not len(ignored):
            return self
        asked = kept(self.pairs, ignored)
        return Contacts.of_spheres(self.duration, self.pairs[asked], self.begin[asked], self.end[asked])

    def __len__(self) -> int:
        return len(self.onset)

    @property
    def lengths(self) -> Floats:
        """(m,) s: how long each contact lasts."""
        lengths: Floats = self.release - self.onset
        return lengths

    def begin_until(self, time: float) -> Flags:
        """(m,) bool array: the contacts that begin after 0 and up to `time` (s).

        >>> onset = np.array([0.0, 2.0, 5.0])
        >>> Contacts.of_spheres(9.0, np.array([[0, 1]] * 3), onset, onset + 1.0).begin_until(4.0).tolist()
        [False, True, False]
        """
        begun: Flags = (self.onset > 0.0) & (self.onset <= time)
        return begun
