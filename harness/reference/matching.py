"""Which reported hit is which contact of the reference: one to one, and in order.

A hit belongs to the encounter of its pair (see `harness.reference.contacts`) in whose time it falls; a hit outside of
every encounter of its pair is extra. Within an encounter the hits and the contacts, both in the order of time, are
matched one to one so that

1. no hit is a report of a contact that had ended before it, and the order is kept;
2. as many as possible are matched;
3. the sum of the time differences |hit - onset| is the smallest possible.

A hit may come before the onset: where the method sees a larger shape than the reference, or touches at a tolerance. A
contact without a hit is missed, a hit without a contact extra. So a contact between two frames is missed, two contacts
that frames cannot tell apart are one match and one miss, and a contact reported twice is one match and one
extra. What touches at time 0 has no onset: it may be reported or not, and counts neither way.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from harness.arrays import Floats, Ints, Pairs
from harness.kernel import kernel
from harness.reference.contacts import Contacts

# Times of two methods that differ by so little, of the duration or of the encounter, differ by rounding.
ROUNDING, SHARE = 1e-13, 1e-6


@dataclass(frozen=True, eq=False)
class Matching:
    """How many of the reference's hits and of the reported ones are matched.

    Parameters
    ----------
    hits : number of the reference's hits: contacts that begin before the method's run ends
    missed : of these, those without a report
    extra : reports without a contact
    errors : (k,) float array, s: reported time - onset, of the matched hits in the order of the contacts
    matched : (k,) int array, which contacts these are
    """

    hits: int
    missed: int
    extra: int
    errors: Floats
    matched: Ints

    @property
    def missed_share(self) -> float:
        """Missed hits, as a fraction of the reference's hits; 0 where it has none."""
        return self.missed / max(1, self.hits)

    @property
    def extra_share(self) -> float:
        """Extra hits, as a fraction of the reference's hits, or of one where it has none."""
        return self.extra / max(1, self.hits)


def match(contacts: Contacts, times: Floats, pairs: Pairs, until: float) -> Matching:
    """Match the hits that a method reports with the contacts of the reference.

    Parameters
    ----------
    contacts : of the reference
    times : (h,) float array, s; when a hit was reported
    pairs : (h, 2) int array, i < j; between whom
    until : s; the end of the method's run. Contacts that begin later, and hits after the reference's end, do not count.

    >>> pair, onset = np.array([0, 1]), np.array([1.0, 4.0])
    >>> contacts = Contacts.of_spheres(10.0, np.array([pair, pair]), onset, onset + 0.5)
    >>> found = match(contacts, np.array([1.25]), np.array([pair]), until=10.0)
    >>> found.hits, found.missed, found.extra, found.errors.tolist()
    (2, 1, 0, [0.25])
    """
    within = times <= contacts.duration * (1.0 + ROUNDING)
    times, pairs = times[within], pairs[within]
    order = np.lexsort((times, pairs[:, 1], pairs[:, 0]))
    times, pairs = times[order], pairs[order]
    slack = ROUNDING * contacts.duration
    margins = slack + SHARE * (contacts.end - contacts.begin)
    encounter_of = np.full(len(times), -1, np.int64)
    _assign(contacts.pairs, contacts.begin - margins, contacts.end + margins, pairs, times, encounter_of)
    inside, hit_of = np.flatnonzero(encounter_of >= 0), np.full(len(contacts), -1, np.int64)
    _match(contacts.encounter, contacts.onset, contacts.release + slack, encounter_of[inside], times[inside], hit_of)
    matched = hit_of >= 0
    counted = contacts.begin_until(until)
    reported = times[inside][hit_of[counted & matched]]
    return Matching(
        hits=int(np.count_nonzero(counted)),
        missed=int(np.count_nonzero(counted & ~matched)),
        extra=len(times) - int(np.count_nonzero(matched)),
        errors=reported - contacts.onset[counted & matched],
        matched=np.flatnonzero(counted & matched),
    )


@kernel
def _assign(met: Pairs, begin: Floats, end: Floats, pairs: Pairs, times: Floats, encounter_of: Ints) -> None:
    """The encounter of each hit, or -1. Encounters, of the pairs `met`, and hits are sorted by pair and time."""
    e = 0
    for h in range(len(times)):
        i, j = pairs[h]
        while e < len(begin) and (
            met[e, 0] < i or (met[e, 0] == i and (met[e, 1] < j or (met[e, 1] == j and end[e] < times[h])))
        ):
            e += 1
        if e < len(begin) and met[e, 0] == i and met[e, 1] == j and begin[e] <= times[h]:
            encounter_of[h] = e


@kernel
def _match(encounter: Ints, onset: Floats, release: Floats, encounter_of: Ints, times: Floats, hit_of: Ints) -> None:
    """Encounter by encounter; `hit_of` becomes the hit of each contact, or stays -1. All hits have an encounter."""
    c = 0
    h = 0
    while c < len(onset):
        current = encounter[c]
        next_c = c
        while next_c < len(onset) and encounter[next_c] == current:
            next_c += 1
        while h < len(times) and encounter_of[h] < current:
            h += 1
        next_h = h
        while next_h < len(times) and encounter_of[next_h] == current:
            next_h += 1
        if next_h > h:
            _match_one(onset[c:next_c], release[c:next_c], times[h:next_h], h, hit_of[c:next_c])
        c, h = next_c, next_h


@kernel
def _match_one(onset: Floats, release: Floats, times: Floats, first: int, hit_of: Ints) -> None:
    """The best matching of one encounter, from those of its first contacts and hits (dynamic programming)."""
    m, n = len(onset), len(times)
    matches = np.zeros((m + 1, n + 1), np.int64)
    cost = np.zeros((m + 1, n + 1))
    for a in range(1, m + 1):
        for b in range(1, n + 1):
            most, least = matches[a - 1, b], cost[a - 1, b]
            if _better(matches[a, b - 1], cost[a, b - 1], most, least):
                most, least = matches[a, b - 1], cost[a, b - 1]
            together = cost[a - 1, b - 1] + _difference(onset[a - 1], release[a - 1], times[b - 1])
            if together < inf and _better(matches[a - 1, b - 1] + 1, together, most, least):
                most, least = matches[a - 1, b - 1] + 1, together
            matches[a, b], cost[a, b] = most, least
    a, b = m, n
    while a > 0 and b > 0:
        if matches[a, b] == matches[a - 1, b] and cost[a, b] == cost[a - 1, b]:
            a -= 1
        elif matches[a, b] == matches[a, b - 1] and cost[a, b] == cost[a, b - 1]:
            b -= 1
        else:
            a -= 1
            b -= 1
            hit_of[a] = first + b


@kernel
def _better(matches: int, cost: float, than_matches: int, than_cost: float) -> bool:
    return matches > than_matches or (matches == than_matches and cost < than_cost)


@kernel
def _difference(onset: float, release: float, time: float) -> float:
    """How far a report is from the onset, or inf where the contact had ended before."""
    return abs(time - onset) if time <= release else inf
