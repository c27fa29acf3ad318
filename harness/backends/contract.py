"""What an answer of a backend must be, and what it gets to answer by: checked alike in sweeps and in comparisons."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.arrays import Floats, Pairs
from harness.backends.protocol import ImpactTimes, NearPairs


class ContractError(ValueError):
    """An answer is not what was asked for; the message names the backend."""


def require_pairs(name: str, answer: object, count: int) -> Pairs:
    """The answer of a backend, if it is one.

    Parameters
    ----------
    name : of the backend
    answer : what its `pairs` returned
    count : of bodies

    Returns
    -------
    (k, 2) int64 array
        Pairs i < j of bodies that there are, sorted, each once.

    Raises
    ------
    ContractError

    >>> require_pairs("mine", [[0, 1], [0, 2]], 3).tolist()
    [[0, 1], [0, 2]]
    >>> require_pairs("mine", [[1, 0]], 3)
    Traceback (most recent call last):
    harness.backends.contract.ContractError: backend "mine": a pair must be i < j, not (1, 0)
    """
    try:
        found = np.asarray(answer)
    except ValueError as error:
        raise ContractError(f'backend "{name}": its answer is no array: {error}') from error
    if found.size == 0 and found.dtype != np.object_:
        return np.empty((0, 2), np.int64)
    if found.ndim != 2 or found.shape[1] != 2 or not np.issubdtype(found.dtype, np.integer):
        raise ContractError(
            f'backend "{name}": an answer must be a (k, 2) array of body numbers, not {found.dtype} of shape '
            f"{found.shape}"
        )
    pairs: Pairs = found.astype(np.int64, copy=False)
    low, high = pairs[:, 0], pairs[:, 1]
    if (wrong := low >= high).any():
        raise ContractError(f'backend "{name}": a pair must be i < j, not {_first(pairs, wrong)}')
    if (wrong := (low < 0) | (high >= count)).any():
        raise ContractError(f'backend "{name}": there is no such pair of {count} bodies: {_first(pairs, wrong)}')
    steps = np.diff(low * count + high)
    if (steps == 0).any():
        raise ContractError(f'backend "{name}": a pair is there twice: {_first(pairs[1:], steps == 0)}')
    if (steps < 0).any():
        raise ContractError(f'backend "{name}": the pairs are not sorted: {_first(pairs[1:], steps < 0)} is late')
    return pairs


def require_gaps(name: str, answer: object, count: int, within: float) -> NearPairs:
    """The answer of a backend to how far apart bodies are, if it is one.

    Parameters
    ----------
    name : of the backend
    answer : what its `distances` returned
    count : of bodies
    within : m, what it was asked for

    Raises
    ------
    ContractError

    >>> require_gaps("mine", ([[0, 1]], [0.25], None), 3, 0.5)
    NearPairs(pairs=array([[0, 1]]), gaps=array([0.25]), points=None)
    >>> require_gaps("mine", ([[0, 1]], [0.75], None), 3, 0.5)
    Traceback (most recent call last):
    harness.backends.contract.ContractError: backend "mine": the gap of (0, 1) must be from 0 to 0.5 m, not 0.75
    """
    parts = _parts(name, answer, ("pairs", "gaps", "points"))
    pairs = require_pairs(name, parts[0], count)
    gaps = _numbers(name, "gap", parts[1], pairs, within, "m")
    if parts[2] is None:
        return NearPairs(pairs, gaps, None)
    points = _floats(name, "nearest points", parts[2], (len(pairs), 2, 3))
    if (wrong := (gaps > 0.0) & ~np.isfinite(points).all(axis=(1, 2))).any():
        raise ContractError(f'backend "{name}": the nearest points of {_first(pairs, wrong)} are not finite')
    return NearPairs(pairs, gaps, points)


def require_impacts(name: str, answer: object, count: int, duration: float) -> ImpactTimes:
    """The answer of a backend to when bodies touch, if it is one.

    Parameters
    ----------
    name : of the backend
    answer : what its `impacts` returned
    count : of bodies
    duration : s, of the frame

    Raises
    ------
    ContractError

    >>> require_impacts("mine", ([[0, 1]], [-1.0]), 3, 0.5)
    Traceback (most recent call last):
    harness.backends.contract.ContractError: backend "mine": the time of (0, 1) must be from 0 to 0.5 s, not -1
    """
    parts = _parts(name, answer, ("pairs", "times"))
    pairs = require_pairs(name, parts[0], count)
    return ImpactTimes(pairs, _numbers(name, "time", parts[1], pairs, duration, "s"))


def require_counters(name: str, counters: object) -> dict[str, float]:
    """What a backend has counted so far, if it counts: numbers of work from 0 on, by the metrics that they are.

    What a run counts itself, such as `frames`, no backend counts for it.

    Raises
    ------
    ContractError

    >>> require_counters("mine", {"narrow_tests": 3})
    {'narrow_tests': 3}
    >>> require_counters("mine", {"narrow_tests": -3})
    Traceback (most recent call last):
    harness.backends.contract.ContractError: backend "mine": its counter narrow_tests must be 0 or more, not -3
    """
    if not isinstance(counters, Mapping):
        raise ContractError(f'backend "{name}": its counters must be numbers by name, not {type(counters).__name__}')
    found = {}
    for counter, value in counters.items():
        if counter not in COUNTERS:
            raise ContractError(f'backend "{name}": it cannot count {counter}, only {", ".join(COUNTERS)}')
        if not isinstance(value, int | float | np.integer | np.floating) or not 0.0 <= value < np.inf:
            raise ContractError(f'backend "{name}": its counter {counter} must be 0 or more, not {value!r}')
        found[str(counter)] = value if isinstance(value, int | float) else value.item()
    return found


COUNTERS = ("pair_tests", "narrow_tests", "hull_tests", "hull_searches", "fcl_tests", "advancement_steps")
"""Of work: metrics that a backend may count."""


def made(answer: object) -> object:
    """An answer in arrays: what is none yet is made one here, where the clock of the backend runs.

    What cannot be one stays as it is, for `require_pairs` and its like to refuse.
    """
    if answer is None or type(answer) is np.ndarray:
        return answer
    if isinstance(answer, tuple):
        return tuple(made(part) for part in answer)
    try:
        return np.asarray(answer)
    except ValueError:
        return answer


def read_only(poses: Floats) -> Floats:
    """The same numbers, which a backend cannot write to, nor make writable: of such a buffer NumPy makes none."""
    view: Floats = np.asarray(poses.data.toreadonly())
    return view


def _parts(name: str, answer: object, parts: tuple[str, ...]) -> tuple[object, ...]:
    if not isinstance(answer, tuple) or len(answer) != len(parts):
        raise ContractError(f'backend "{name}": an answer must be a tuple of {", ".join(parts)}')
    return answer


def _numbers(name: str, what: str, answer: object, pairs: Pairs, most: float, unit: str) -> Floats:
    """One number a pair, from 0 to the most."""
    numbers = _floats(name, f"{what}s", answer, (len(pairs),))
    if (wrong := ~((numbers >= 0.0) & (numbers <= most))).any():  # so that nan is wrong too
        raise ContractError(
            f'backend "{name}": the {what} of {_first(pairs, wrong)} must be from 0 to {most:g} {unit}, '
            f"not {numbers[wrong][0]:.17g}"
        )
    return numbers


def _floats(name: str, what: str, answer: object, shape: tuple[int, ...]) -> Floats:
    try:
        found = np.asarray(answer)
    except ValueError as error:
        raise ContractError(f'backend "{name}": its {what} are no array: {error}') from error
    if found.size == 0 == np.prod(shape):
        return np.empty(shape)
    if found.shape != shape or not np.issubdtype(found.dtype, np.floating):
        raise ContractError(
            f'backend "{name}": its {what} must be a float array of shape {shape}, not {found.dtype} of shape '
            f"{found.shape}"
        )
    floats: Floats = found.astype(np.float64, copy=False)
    return floats


def _first(pairs: Pairs, wrong: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> tuple[int, int]:
    i, j = pairs[int(wrong.argmax())].tolist()
    return i, j
