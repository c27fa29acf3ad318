"""What an answer of a backend must be, and what it gets to answer by: checked alike in sweeps and in comparisons."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Pairs


class ContractError(ValueError):
    """An answer is no list of pairs; the message names the backend."""


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


def read_only(poses: Floats) -> Floats:
    """The same numbers, which a backend cannot write to."""
    view: Floats = poses.view()
    view.flags.writeable = False
    return view


def _first(pairs: Pairs, wrong: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> tuple[int, int]:
    i, j = pairs[int(wrong.argmax())].tolist()
    return i, j
